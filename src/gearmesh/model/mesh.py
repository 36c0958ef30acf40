"""The stiffness of the mesh of a problem, whichever way it is stated, and its backlash."""

from collections.abc import Iterator

from gearmesh.model import stiffness
from gearmesh.model.functions import Harmonic, Number, harmonic_sum
from gearmesh.model.problem import Problem


def mesh_phase(problem: Problem, time: Number) -> Number:
    """Return the mesh phase at `time`, in mesh periods from t = 0 of eq. (4)."""
    return time / problem.period


def since(phase: Number, place: float) -> Number:
    """Return how far `phase` is behind `place`, whole mesh periods apart or not."""
    passed = phase - place
    return passed - round(passed)


def mesh_stiffness(problem: Problem, phase: Number, segment: float | None = None) -> Number:
    """Return C / C_s at the mesh phase `phase`.

    `segment`, any phase between the same two jumps, chooses the side of a jump; it counts whole
    periods if single teeth have factors.
    """
    segment = phase if segment is None else segment
    terms = problem.terms
    if not (terms.tooth_pair_stiffness or terms.tooth_factors):
        return _whole(problem, phase, segment, since(phase, segment))
    return sum(pair_stiffnesses(problem, phase, segment))


def pair_stiffnesses(problem: Problem, phase: Number, segment: float) -> list[Number]:
    """Return the stiffness of each pair of teeth in contact, in C_s. Their sum is C(t).

    If C(t) is stated for the whole mesh, the pairs share it evenly before their tooth factors act.
    """
    passed = since(phase, segment)
    terms = problem.terms
    pairs = stiffness.touching_pairs(segment, problem.contact_ratio)
    if not terms.tooth_pair_stiffness:
        shared = _whole(problem, phase, segment, passed)
        return [_factor(problem, pair.number) / len(pairs) * shared for pair in pairs]
    points = len(terms.tooth_pair_stiffness)
    ends = stiffness.path_places(problem.contact_ratio, points)
    knots = [
        (end - stiffness.PITCH_PHASE, value)
        for end, value in zip(ends, terms.tooth_pair_stiffness, strict=True)
    ]
    found = []
    for pair in pairs:
        value, slope = stiffness.line_through(knots, pair.place)
        found.append(_factor(problem, pair.number) * (value + slope * passed))
    return found


def _whole(problem: Problem, phase: Number, segment: float, passed: Number) -> Number:
    """Return C / C_s where it is stated for the mesh, not for its pairs of teeth."""
    terms = problem.terms
    if terms.stiffness_table:
        value, slope = stiffness.line_through(terms.stiffness_table, segment % 1.0)
        return value + slope * passed
    harmonics = [*stiffness_harmonics(problem)]
    if harmonics:
        return stiffness.mean(*_levels(problem)) + harmonic_sum(harmonics, stiffness.TURN * phase)
    return float(stiffness.rectangular(segment, *_levels(problem)))


def _levels(problem: Problem) -> tuple[float, float, float]:
    return problem.contact_ratio, problem.stiffness_max, problem.stiffness_min


def stiffness_harmonics(problem: Problem) -> Iterator[Harmonic]:
    """Yield the harmonics of C(t) / C_s, where it is a Fourier series."""
    amplitudes = stiffness.fourier_amplitudes(*_levels(problem), problem.stiffness_harmonics)
    for n, amplitude in enumerate(amplitudes, start=1):
        yield Harmonic(n, float(amplitude), 0.0)
    for n, (cosine, sine) in enumerate(problem.terms.stiffness_fourier, start=1):
        yield Harmonic(n, cosine, sine)


def _factor(problem: Problem, number: int) -> float:
    """Return the factor of the pair of teeth with this number."""
    product = 1.0
    for wheel, tooth, factor in problem.terms.tooth_factors:
        teeth = problem.both_wheels[0 if wheel == 3 else 1].teeth
        if number % teeth == tooth:
            product *= factor
    return product


def backlash(problem: Problem, time: Number) -> Number:
    """Return s(t) / y_st as it is stated, without the effect of moving wheel centres."""
    harmonics = problem.terms.backlash_harmonics
    return problem.backlash + harmonic_sum(harmonics, problem.nu * time)
