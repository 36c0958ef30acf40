"""The first event of a step: a turning point of y, or the level that ends the regime.

Both are found on the Taylor polynomials of a step, in all lanes at once. Each lane watches one
function for its first change of sign:

- y itself, measured from the level where the flanks part, while they touch, turning points do not
  count (before the kept revolutions) and do not bend the damping (no |v| v);
- v otherwise. Up to the first turning point y is monotone, so it crosses a level at most once and
  its end tells whether it does.

Either way an orbit that dips through y = 0 and returns within a step (grazing) is seen. What is
watched is sampled at `N_SAMPLES` places; between two of them a pair of changes of sign can hide
only where it has a minimum. The two tangents bound that minimum from below, and where they meet
below 0 it is computed.
"""

from numba import njit

from gearmesh.solver.lanes import any_lane, fma, load, magnitude, select, spread
from gearmesh.solver.taylor import (
    ORDER,
    REST,
    SIGN,
    STEP,
    WATCHED,
    Y,
    evaluate,
    evaluate_with_bend,
    evaluate_with_slope,
)

N_SAMPLES = 8
# A step of Halley's method this small leaves an error of its cube.
_CONVERGED = 1e-7
# Far enough for the value at the minimum, which is flat there.
_DIP_PLACE = 1e-7
_MOST_ITERATIONS = 60


@njit(inline="always")
def _halley(at, value, slope, bend):
    """Return the next place of Halley's method, and whether it is the last; `bend` is f''/2.

    Newton's step decides: beside a double root Halley's is small far from any root.
    """
    newton = value / slope
    settled = magnitude(newton) <= spread(at, _CONVERGED)
    return at - newton / (1.0 - newton * bend / slope), settled


@njit(inline="always")
def _dip(like, work, sign, suspect, low, high):
    """Return the minimum of what is watched between `low` and `high`, and its place."""
    zero = spread(like, 0.0)
    at = 0.5 * (low + high)
    active = suspect
    for _ in range(_MOST_ITERATIONS):
        _, slope, bend = evaluate_with_bend(like, work, WATCHED, ORDER + 1, at)
        falling = sign * slope < zero
        low = select(falling, at, low)
        high = select(falling, high, at)
        following = at - slope / (2.0 * bend)
        inside = (following > low) & (following < high)
        following = select(inside, following, 0.5 * (low + high))
        settled = magnitude(following - at) <= spread(like, _DIP_PLACE)
        at = select(active, following, at)
        active = active & ~settled
        if not any_lane(active):
            break
    value = evaluate(like, work, WATCHED, ORDER + 1, at)
    return sign * value, at


@njit(inline="never")
def bracket(like, work, sign):
    """Return whether sign times what is watched falls through 0, a bracket of where, a guess."""
    zero = spread(like, 0.0)
    step = load(like, work, STEP)
    low = zero
    high = step
    # Values at both ends of the bracket, for the first guess.
    low_value = zero
    high_value = zero
    found = zero > zero
    before = sign * load(like, work, WATCHED)
    slope_before = sign * load(like, work, WATCHED + 1)
    place_before = zero
    rest = spread(like, REST)
    width = step * (1.0 / N_SAMPLES)
    for j in range(1, N_SAMPLES + 1):
        place = width * float(j)
        value, slope = evaluate_with_slope(like, work, WATCHED, ORDER + 1, place)
        value = sign * value
        slope = sign * slope
        dips = (slope_before < zero) & (slope > zero) & (value >= zero) & ~found
        if any_lane(dips):
            # Where the tangents of both ends meet: below the minimum of a convex course.
            where = (value - before - slope * width) / (slope_before - slope)
            suspect = dips & (fma(slope_before, where, before) <= zero)
            if any_lane(suspect):
                lowest, at = _dip(like, work, sign, suspect, place_before, place)
                suspect = suspect & (lowest < -rest)
                low = select(suspect, place_before, low)
                high = select(suspect, at, high)
                low_value = select(suspect, before, low_value)
                high_value = select(suspect, lowest, high_value)
                found = found | suspect
        falls = (value < -rest) & ~found
        low = select(falls, place_before, low)
        high = select(falls, place, high)
        low_value = select(falls, before, low_value)
        high_value = select(falls, value, high_value)
        found = found | falls
        before = value
        slope_before = slope
        place_before = place
    guess = low + (high - low) * (low_value / (low_value - high_value))
    # A step that begins at an event must not find that event again.
    guess = select(low_value <= rest, high, guess)
    return found, low, high, guess


@njit(inline="never")
def fall(like, work, sign, wanted, low, high, at):
    """Return where what is watched passes 0 between `low` and `high`: Halley's method from `at`."""
    zero = spread(like, 0.0)
    active = wanted
    for _ in range(_MOST_ITERATIONS):
        value, slope, bend = evaluate_with_bend(like, work, WATCHED, ORDER + 1, at)
        forward = sign * value > zero
        low = select(active & forward, at, low)
        high = select(active & ~forward, at, high)
        following, settled = _halley(at, value, slope, bend)
        inside = (following > low) & (following < high)
        following = select(inside | settled, following, 0.5 * (low + high))
        at = select(active, following, at)
        active = active & ~settled
        if not any_lane(active):
            break
    return at


@njit(inline="never")
def crossing(like, work, level, wanted, end):
    """Return where y, monotone up to `end`, passes `level`: Halley's method, bracketed."""
    sign = load(like, work, SIGN)
    zero = spread(like, 0.0)
    low = zero
    high = end
    start = load(like, work, Y)
    last = evaluate(like, work, Y, ORDER + 1, end)
    at = end * ((level - start) / (last - start))
    at = select((at > low) & (at < high), at, 0.5 * end)
    active = wanted
    for _ in range(_MOST_ITERATIONS):
        value, slope, bend = evaluate_with_bend(like, work, Y, ORDER + 1, at)
        short = sign * (value - level) < zero
        low = select(active & short, at, low)
        high = select(active & ~short, at, high)
        following, settled = _halley(at, value - level, slope, bend)
        inside = (following > low) & (following < high)
        following = select(inside | settled, following, 0.5 * (low + high))
        at = select(active, following, at)
        active = active & ~settled
        if not any_lane(active):
            break
    return at
