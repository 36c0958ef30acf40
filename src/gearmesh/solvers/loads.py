"""What engineers report of a run: tooth force, transmission error, bearing forces.

The general solver locates the extremes of the kept revolutions between the samples. For the reduced
solver they are taken from the samples. The tooth force jumps where the rectangular stiffness
switches, and where damped teeth meet or part, so its values on both sides of each jump are added to
the samples. The error of the extremes is then about (2 pi order / samples per period)^2 / 8 of the
amplitude, which is 7e-4 for the third harmonic and 256 samples.
"""

from dataclasses import dataclass

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, elastic_force, touching_level
from gearmesh.model.damping import damping_force
from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import switch_phases
from gearmesh.solvers.response import Samples


@dataclass(frozen=True, slots=True)
class Loads:
    """Loads of one run; forces in F_st, lengths in y_st.

    Attributes
    ----------
    force_max, force_min : float
        Largest and least normal force of the mesh. A negative one presses on the rear flanks, or
        pulls.
    transmission_error_rms : float
        Root mean square of the dynamic transmission error about its mean.
    transmission_error_range : float
        Its greatest value less its least.
    force_bearing_3_max, force_bearing_2_max : float
        Greatest amount of the force on the bearing of each wheel, along the mesh line.
    force_bearing_3_z_max, force_bearing_2_z_max : float
        The same across the mesh line; NaN for the reduced system, which does not contain it.
    """

    force_max: float
    force_min: float
    transmission_error_rms: float
    transmission_error_range: float
    force_bearing_3_max: float
    force_bearing_2_max: float
    force_bearing_3_z_max: float
    force_bearing_2_z_max: float


def loads(problem: Problem, samples: Samples) -> Loads:
    """Measure the loads of a run on its samples."""
    extremes = samples.extremes
    if extremes is None:
        extremes = _on_samples(problem, samples)
    force, error, *bearings = extremes
    return Loads(
        force_max=float(force[1]),
        force_min=float(force[0]),
        transmission_error_rms=float(samples.transmission_error.std()),
        transmission_error_range=float(np.ptp(error)),
        force_bearing_3_max=float(np.abs(bearings[0]).max()),
        force_bearing_2_max=float(np.abs(bearings[1]).max()),
        force_bearing_3_z_max=float(np.abs(bearings[2]).max()),
        force_bearing_2_z_max=float(np.abs(bearings[3]).max()),
    )


def _on_samples(problem: Problem, samples: Samples) -> np.ndarray:
    """Return the extremes of a run of the reduced solver, in the form of `Samples.extremes`."""
    jumps = *_at_switches(problem, samples), *_at_contacts(problem, samples)
    rows = (
        np.concatenate([samples.force_normal, *jumps]),
        samples.transmission_error,
        samples.force_bearing_3,
        samples.force_bearing_2,
    )
    missing = [(np.nan, np.nan)] * 2
    return np.array([*((row.min(), row.max()) for row in rows), *missing])


def _at_switches(problem: Problem, samples: Samples) -> list[np.ndarray]:
    """Return the normal force before and after each switch of the rectangular stiffness."""
    places = np.flatnonzero(np.diff(samples.stiffness))
    phase = samples.time[places] / problem.period + problem.initial_phase
    waits = [(switch - phase) % 1.0 for switch in switch_phases(problem.contact_ratio)]
    y, v = _advanced(samples, places, np.minimum(*waits) * problem.period)
    regime = samples.regime[places]
    damping = _damping(problem, v, regime == CONTACT_LOSS)
    return [
        elastic_force(y, stiffness, regime, problem.backlash) + damping
        for stiffness in (samples.stiffness[places], samples.stiffness[places + 1])
    ]


def _at_contacts(problem: Problem, samples: Samples) -> list[np.ndarray]:
    """Return the normal force on both sides of each place where teeth meet or part.

    The elastic force is 0 there, and the damping is that of the material or of the lubricant.
    """
    regime = samples.regime
    places = np.flatnonzero(np.diff(regime))
    touching = np.where(regime[places] == CONTACT_LOSS, regime[places + 1], regime[places])
    distance = touching_level(touching, problem.backlash) - samples.y[places]
    v, a = samples.v[places], samples.a[places]
    # The root of v d + a d^2/2 = distance that goes over into distance/v without acceleration.
    root = np.sqrt(np.maximum(v * v + 2.0 * a * distance, 0.0))
    sum_ = v + np.copysign(root, v)
    wait = np.divide(2.0 * distance, sum_, out=np.zeros_like(sum_), where=sum_ != 0.0)
    _, speed = _advanced(samples, places, wait)
    return [_damping(problem, speed, np.full(speed.size, lost)) for lost in (False, True)]


def _advanced(
    samples: Samples, places: np.ndarray, wait: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return y and v a while after some samples."""
    y, v, a = samples.y[places], samples.v[places], samples.a[places]
    return y + wait * (v + 0.5 * wait * a), v + wait * a


def _damping(problem: Problem, v: np.ndarray, lost: np.ndarray) -> np.ndarray:
    force: np.ndarray = damping_force(v, problem.material)
    force[lost] = damping_force(v[lost], problem.lubricant)
    return force
