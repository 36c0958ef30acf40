"""The search for orbits of the general solver: a long run, and Newton's method from its end."""

import math
from dataclasses import replace

import numpy as np

from gearmesh.dynamics.periodic.charts import HELD, chart_of
from gearmesh.dynamics.periodic.general_orbits import (
    SAME,
    GeneralOrbit,
    common_period,
    end_of,
    run_of,
    shot_from,
)
from gearmesh.dynamics.periodic.orbits import Orbit
from gearmesh.errors import NoOrbit
from gearmesh.model.motion import start
from gearmesh.model.problem import Problem, State
from gearmesh.solvers.full.coordinates import signs_act
from gearmesh.solvers.reduced.derivatives.curves import LARGEST_RESIDUAL

_MOST_CORRECTIONS = 30
_SHORTEST_CORRECTION = 1.0 / 64.0
_TRANSIENT = 1000  # mesh periods after which the end of a run serves as an initial state
_BLOCK = 20  # least mesh periods after which a drive corrects the rotation on the way


def find_orbit(problem: Problem, periods: int = 1) -> GeneralOrbit:
    """Return an orbit of least period `periods` near the initial state of the problem.

    If the problem has none, the search begins at the end of a long run from rest.

    Raises
    ------
    NoOrbit
        If there is none, or if the excitation does not repeat.
    """
    common = common_period(problem)
    if periods % common:
        raise NoOrbit(
            f"the excitation repeats after {common} mesh periods; periods has to be a multiple"
        )
    bare = replace(problem, initial_state=None)
    place = chart_of(problem).place_of_six(np.concatenate(start(problem)))
    if problem.initial_state is None:
        return correct(_settled(bare, place, periods))
    passed = problem.start_period % common
    if passed:
        rest = run_of(bare, problem.initial_state, common - passed, 0).final_state
        if rest is None:
            raise NoOrbit("the motion from the start cannot be integrated")
        place = chart_of(problem).place_of_six(np.array(rest.coordinates))
    return correct(shot_from(bare, chart_of(problem).unknowns(place), periods, float(place[0])))


def in_all_coordinates(orbit: Orbit) -> GeneralOrbit:
    """Return an orbit of the reduced system as one of the general solver.

    Raises
    ------
    NoOrbit
        If Newton's method leads away from it.
    """
    state = State(*orbit.state.tolist())
    return find_orbit(replace(orbit.problem, initial_state=state), orbit.periods)


def _settled(problem: Problem, place: np.ndarray, periods: int) -> GeneralOrbit:
    """Return the motion at the end of a long run from a place.

    If the mean rotation has to be held, a drive corrects it after whole periods of the orbit.
    """
    chart, angle = chart_of(problem), float(place[0])
    shortest = _BLOCK if chart.rotation == HELD else _TRANSIENT
    block = periods * math.ceil(shortest / periods)
    state = chart.unknowns(place)
    for _ in range(math.ceil(_TRANSIENT / block)):
        moved = shot_from(problem, state, block, angle)
        state = chart.carried_on(moved.start, moved.end, float(state[0]), block * problem.period)
    return shot_from(problem, chart.rescaled(state, block, periods), periods, angle)


def correct(orbit: GeneralOrbit) -> GeneralOrbit:
    """Return the orbit to which Newton's method leads."""
    problem, periods = orbit.problem, orbit.periods
    for _ in range(_MOST_CORRECTIONS):
        correction = np.linalg.lstsq(orbit.gradient, -orbit.defect, rcond=1e-14)[0]
        share = 1.0
        shortest = 1.0 if orbit.residual < LARGEST_RESIDUAL else _SHORTEST_CORRECTION
        while share >= shortest:
            try:
                candidate = orbit.shot(problem, orbit.state + share * correction, periods)
            except NoOrbit:  # the motion runs away; from a nearer state it may not
                share *= 0.5
                continue
            if candidate.residual < (1.0 - 0.1 * share) * orbit.residual:
                break
            share *= 0.5
        else:
            break
        orbit = candidate
    if not orbit.residual < LARGEST_RESIDUAL:
        reason = f"Newton's method stops at a residual of {orbit.residual:.1e}"
        if signs_act(problem):
            reason += "; friction with run-out often repeats after two revolutions only"
        raise NoOrbit(reason)
    for shorter in range(orbit.repeats_after, periods, orbit.repeats_after):
        if periods % shorter == 0:
            end = end_of(orbit.held, shorter, orbit.start)
            if np.abs(orbit.chart.closing(orbit.start, end)).max() < SAME:
                raise NoOrbit(f"Newton's method leads to an orbit of period {shorter}")
    return orbit
