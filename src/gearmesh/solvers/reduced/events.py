"""The first event of a step: a turning point of y, or the level that ends the regime.

Both are found on the Taylor polynomials of a step, in all lanes at once. In each lane one function
is watched for its first change of sign:

- y itself, measured from the level where the flanks part, while they touch, turning points do not
  count (before the kept revolutions) and do not bend the damping (no |v| v);
- v otherwise. Up to the first turning point y is monotone, so it passes a level at most once, and
  the value of y shows whether it has.

Either way an orbit that dips through y = 0 and returns within a step (grazing) is found. The
function is evaluated at `N_PLACES` places; between two of them a pair of changes of sign can hide
only where the function has a minimum. The two tangents bound that minimum from below, and where
they meet below 0 it is computed.
"""

from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import any_lane, fma, magnitude, select, spread
from gearmesh.solvers.lanes.rows import load, store
from gearmesh.solvers.reduced.taylor import REST, evaluate_places, evaluate_with_twist
from gearmesh.solvers.reduced.workspace import (
    EVENT,
    GUARD,
    LEVEL_ABOVE,
    LEVEL_BELOW,
    N_PLACES,
    OFFSET,
    PLACE_HALF_A,
    PLACE_V,
    PLACE_Y,
    REMAINING,
    SIGN,
    STEP,
    TAKEN,
    Y,
)

PASSED, TURNED, CROSSED, SEGMENT_ENDED = 0.0, 1.0, 2.0, 3.0
"""What ends a step: its length alone, a turning point, a level, the end of the segment."""

_SETTLED = 1e-14
# Far enough for the value at the minimum, which is flat there.
_DIP_PLACE = 1e-7
_MOST_ITERATIONS = 60


@inner(inline="always")
def _dip(like, work, guards, side, floor, suspect, low, high):
    """Return the minimum of what is watched between `low` and `high`, and its place."""
    zero = spread(like, 0.0)
    at = 0.5 * (low + high)
    active = suspect
    value = zero
    for _ in range(_MOST_ITERATIONS):
        y, v, half_a, twist = evaluate_with_twist(like, work, at)
        value = side * select(guards, y - floor, v)
        slope = select(guards, v, 2.0 * half_a)
        bend = select(guards, 2.0 * half_a, 6.0 * twist)
        falling = side * slope < zero
        low = select(falling, at, low)
        high = select(falling, high, at)
        following = at - slope / bend
        inside = (following > low) & (following < high)
        following = select(inside, following, 0.5 * (low + high))
        active = active & ~(magnitude(following - at) <= spread(like, _DIP_PLACE))
        at = select(active, following, at)
        if not any_lane(active):
            break
    return value, at


@inner(inline="never")
def bracket(like, work, guards, side, floor, level):
    """Find the first part of the step in which what is watched falls, or `level` is passed.

    Returns
    -------
    found, passed : mask
        Whether what is watched falls through 0; whether y, still on its way, passes the level.
    low, high : lanes
        The ends of that part.
    guess : lanes
        Where the secant puts the root.
    """
    zero = spread(like, 0.0)
    rest = spread(like, REST)
    sign = load(like, work, SIGN)
    width = load(like, work, STEP) * (1.0 / N_PLACES)
    low = low_value = high_value = zero
    high = load(like, work, STEP)
    found = passed = zero > zero
    y, v = load(like, work, Y), load(like, work, Y + 1)
    before = side * select(guards, y - floor, v)
    slope_before = side * select(guards, v, 2.0 * load(like, work, Y + 2))
    room_before = sign * (level - y)
    evaluate_places(like, work)
    for j in range(N_PLACES):
        y, v = load(like, work, PLACE_Y + j), load(like, work, PLACE_V + j)
        value = side * select(guards, y - floor, v)
        slope = side * select(guards, v, 2.0 * load(like, work, PLACE_HALF_A + j))
        room = sign * (level - y)
        ahead = ~(found | passed)
        falls = (value < -rest) & ahead
        passes = (room < zero) & ahead & ~falls & ~guards
        dips = (slope_before < zero) & (slope > zero) & (value >= zero) & ahead
        if any_lane(dips):
            # Where the tangents of both ends meet: below the minimum of a convex function.
            where = (value - before - slope * width) / (slope_before - slope)
            suspect = dips & (fma(slope_before, where, before) <= zero)
            if any_lane(suspect):
                start, end = width * float(j), width * float(j + 1)
                lowest, at = _dip(like, work, guards, side, floor, suspect, start, end)
                suspect = suspect & (lowest < -rest)
                low = select(suspect, start, low)
                high = select(suspect, at, high)
                low_value = select(suspect, before, low_value)
                high_value = select(suspect, lowest, high_value)
                found = found | suspect
                passes = passes & ~suspect
        ends = falls | passes
        if any_lane(ends):
            found = found | falls
            passed = passed | passes
            low = select(ends, width * float(j), low)
            high = select(ends, width * float(j + 1), high)
            low_value = select(ends, select(passes, room_before, before), low_value)
            high_value = select(ends, select(passes, room, value), high_value)
        before = value
        slope_before = slope
        room_before = room
    guess = low + (high - low) * (low_value / (low_value - high_value))
    # A step that begins at an event must not find that event again.
    guess = select(low_value <= rest, high, guess)
    return found, passed, low, high, guess


@inner(inline="never")
def locate(like, work, wanted, turns, side, level, low, high, at):
    """Return where v, or where `turns` is not set y - `level`, passes 0, and y there.

    Halley's method from `at`, inside the bracket; side times the function falls. Newton's step
    decides when it ends: near a double root Halley's can be small far from any root.
    """
    zero = spread(like, 0.0)
    active = wanted
    y_there = zero
    for _ in range(_MOST_ITERATIONS):
        y, v, half_a, twist = evaluate_with_twist(like, work, at)
        value = select(turns, v, y - level)
        slope = select(turns, 2.0 * half_a, v)
        bend = select(turns, 3.0 * twist, half_a)
        ahead = side * value > zero
        low = select(active & ahead, at, low)
        high = select(active & ~ahead, at, high)
        newton = value / slope
        curved = newton * bend / slope
        following = at - newton / (1.0 - curved)
        # The error that Halley's step leaves, in curvature and in the term after it.
        left = magnitude(newton) * fma(curved, curved, newton * newton)
        settled = left <= spread(like, _SETTLED)
        inside = (following > low) & (following < high)
        following = select(inside | settled, following, 0.5 * (low + high))
        moved = following - at
        y = fma(fma(fma(twist, moved, half_a), moved, v), moved, y)
        y_there = select(active, y, y_there)
        at = select(active, following, at)
        active = active & ~settled
        if not any_lane(active):
            break
    return at, y_there


@inner(inline="never")
def find_event(like, work):
    """Write how far the step goes, up to its first event, and what that event is."""
    zero = spread(like, 0.0)
    step = load(like, work, STEP)
    sign = load(like, work, SIGN)
    guard = load(like, work, GUARD)
    floor = load(like, work, OFFSET)
    guards = ~(guard == zero)
    side = select(guards, guard, sign)
    level = select(sign > zero, load(like, work, LEVEL_ABOVE), load(like, work, LEVEL_BELOW))
    found, passed, low, high, guess = bracket(like, work, guards, side, floor, level)
    ends = step >= load(like, work, REMAINING)
    event = select(ends, spread(like, SEGMENT_ENDED), spread(like, PASSED))
    end = step
    if any_lane(found | passed):
        turned = found & ~guards
        crossed = (found & guards) | passed
        side = select(passed, -sign, side)
        limit = select(guards, floor, level)
        at, y = locate(like, work, found | passed, turned, side, limit, low, high, guess)
        end = select(found | passed, at, step)
        event = select(turned, spread(like, TURNED), event)
        # A turning point may lie beyond the level, which was then passed before it.
        beyond = turned & (sign * (level - y) < zero)
        if any_lane(beyond):
            middle = 0.5 * (low + end)
            at, y = locate(like, work, beyond, zero > zero, -sign, level, low, end, middle)
            end = select(beyond, at, end)
            crossed = crossed | beyond
        event = select(crossed, spread(like, CROSSED), event)
    store(work, TAKEN, end)
    store(work, EVENT, event)
