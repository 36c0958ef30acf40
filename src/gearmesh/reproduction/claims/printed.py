"""Numbers that the paper prints, and numbers that follow from them, computed again."""

import math
from collections.abc import Callable
from functools import reduce

import numpy as np

from gearmesh.model import stiffness
from gearmesh.model.variants import variant
from gearmesh.reproduction.claims.evidence import Evidence
from gearmesh.reproduction.frequencies import FIRST_JUMP
from gearmesh.solvers.simulation import simulate
from gearmesh.study.pair import Pair

HARMONICS = 50


def mean_stiffness(evidence: Evidence) -> tuple[float, str]:
    """P1: C_s of eq. (5)."""
    return evidence.pair.stiffness_mean, "C_s in N/mm, from ε, κ and C_max by eq. (5)"


def least_stiffness(evidence: Evidence) -> tuple[float, str]:
    """P2: C_min."""
    return evidence.pair.stiffness_min, "C_min = κ C_max in N/mm"


def damping_ratios(evidence: Evidence) -> tuple[dict[str, float], str]:
    """P3: proportional damping D with k and with 5k."""
    pair = evidence.pair
    factor = variant("c-material-5x").factor
    ratios = {
        "D": pair.damping_ratio,
        "D of 5k": factor * pair.damping_ratio,
        "k": pair.damping,
        "5k": factor * pair.damping,
    }
    return ratios, "D = k/(2 √(C_s m_red)) with m_red in N s²/mm; k in N s/mm"


def frequencies_of_the_levels(evidence: Evidence) -> tuple[dict[str, float], str]:
    """P4: mesh frequency relative to C_min and to C_max at the first jump."""
    pair = evidence.pair
    values = {
        "nu_min": FIRST_JUMP * pair.nu_min_ratio,
        "nu_max": FIRST_JUMP * pair.nu_max_ratio,
    }
    return values, "ν_s √(C_s/C_x) at ν_s = 0.66"


def resonance_of_least_stiffness(evidence: Evidence) -> tuple[float, str]:
    """P5: ν_s at which ν_min = 1."""
    return 1.0 / evidence.pair.nu_min_ratio, "ν_s where ν_min = 1"


def standard_contact_ratio(evidence: Evidence) -> tuple[float, str]:
    """P6: contact ratio of a standard pair at the pressure angle."""
    angle, teeth = evidence.pair.pressure_angle, evidence.pair.teeth_3
    base, tip = teeth * math.cos(angle) / 2, teeth / 2 + 1
    path = 2 * (math.sqrt(tip**2 - base**2) - base * math.tan(angle))
    ratio = path / (math.pi * math.cos(angle))
    return ratio, f"equal wheels, unit addendum, {math.degrees(angle):g}°; R_b = {base:.4f} modules"


def rectangular_wave(evidence: Evidence) -> tuple[dict[str, float], str]:
    """P7: the coefficients of eq. (4) compared with those of a rectangular wave."""
    pair = evidence.pair
    ratio, c_max = pair.contact_ratio, pair.mesh_stiffness_max
    printed = stiffness.fourier_amplitudes(ratio, c_max, pair.stiffness_min, HARMONICS)
    # The coefficients of the wave are integrals over half a period, in which it falls once.
    n = np.arange(1, HARMONICS + 1)
    fall = stiffness.switch_phases(ratio)[0]
    wave = 2 * (c_max - pair.stiffness_min) * np.sin(2 * np.pi * n * fall) / (np.pi * n)
    values = {"share of C_max": 2 * fall, "difference": float(np.abs(printed - wave).max() / c_max)}
    return values, f"first {HARMONICS} coefficients, difference relative to C_max"


def _trace(nu: float, damping_ratio: float, pair: Pair) -> float:
    """Return the trace of the map over a mesh period of x'' + 2 ζ x' + (C(t)/C_s) x = 0."""
    duty = stiffness.duty(pair.contact_ratio)
    period = 2 * math.pi / nu
    levels = (pair.mesh_stiffness_max, pair.stiffness_min)
    maps = []
    for share, level in zip((duty, 1 - duty), levels, strict=True):
        w = math.sqrt(level / pair.stiffness_mean - damping_ratio**2)
        c, s = math.cos(w * share * period), math.sin(w * share * period)
        maps.append(np.array([[c, s / w], [-w * s, c]]))
    return float(np.trace(reduce(np.matmul, maps)))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function changes its sign; not-a-number if it does not."""
    if not function(low) * function(high) < 0:
        return math.nan
    from scipy.optimize import brentq  # here, because the checks of all figures import this module

    return float(brentq(function, low, high, xtol=1e-8))


def parametric_tongue(evidence: Evidence) -> tuple[dict[str, float], str]:
    """P8: interval of ν_s where the oscillator without contact loss is unstable (Floquet)."""
    pair = evidence.pair

    def excess(nu: float) -> float:
        return abs(_trace(nu, 0.0, pair)) - 2.0

    middle = max(np.linspace(0.6, 0.72, 1201), key=excess)
    edges = _root(excess, 0.6, middle), _root(excess, middle, 0.72)

    def growth(ratio: float) -> float:
        """Return the greatest logarithmic growth over a period, for a damping ratio."""
        nus = np.linspace(*edges, 201)
        traces = np.maximum([abs(_trace(nu, ratio, pair)) / 2 for nu in nus], 1.0)
        # The trace does not contain the factor exp(-ζ T) of the decay.
        return float(np.max(np.arccosh(traces) - ratio * 2 * np.pi / nus))

    values = {"from": edges[0], "to": edges[1], "damping ratio": _root(growth, 1e-4, 0.05)}
    return values, "third parametric resonance, and the damping ratio above which it vanishes"


def constant_coefficients(evidence: Evidence) -> tuple[dict[str, float], str]:
    """P9: amplitude of the motion with constant stiffness, without friction."""
    swings = {}
    for name, ratio in (("ε = 1", 1.0), ("ε = 2", 2.0)):
        pair = evidence.pair.replace(contact_ratio=ratio, friction_coefficient=0.0)
        problem = pair.problem(variant("c-material"), FIRST_JUMP)
        response = simulate([problem], pair.tolerance)[0]
        swings[name] = response.y_max - response.y_min
    return swings, "y_max - y_min in y_st of c-material at ν_s = 0.66"


MEASURES = {
    "P1": mean_stiffness,
    "P2": least_stiffness,
    "P3": damping_ratios,
    "P4": frequencies_of_the_levels,
    "P5": resonance_of_least_stiffness,
    "P6": standard_contact_ratio,
    "P7": rectangular_wave,
    "P8": parametric_tongue,
    "P9": constant_coefficients,
}
