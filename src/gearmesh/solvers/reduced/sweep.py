"""The compiled sweep: many runs of the reduced system, a lane each, from event to event.

The lanes are independent: the steps of each end at its own switches, pitch points, boundaries,
turning points and contact crossings, and it takes the next run of the list as soon as it has
finished one. The arithmetic of a step (`taylor`, `events`) and what follows an event
(`transitions`) is common to all lanes. What is recorded of a run (`measures`), and where it begins
and ends (`records`), is treated lane by lane.
"""

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import (
    WIDEST,
    any_lane,
    lane_bits,
    lowest_bit,
    magnitude,
    select,
    spread,
    width_of,
)
from gearmesh.solvers.lanes.rows import load, store
from gearmesh.solvers.reduced.events import CROSSED, SEGMENT_ENDED, TURNED, find_event
from gearmesh.solvers.reduced.measures import integrate_square, sample, turn
from gearmesh.solvers.reduced.records import begin, finish, idle, pass_boundary
from gearmesh.solvers.reduced.taylor import choose_step, evaluate_with_slope, expand
from gearmesh.solvers.reduced.transitions import cross_level, enter, next_segment
from gearmesh.solvers.reduced.workspace import (
    CUBIC,
    EVENT,
    FARTHEST,
    INVERSE_TIME,
    KEPT,
    LENGTH,
    LOAD,
    LOSS_TIME,
    MOST_STEPS,
    N_PLACES,
    PERIOD,
    PERIODS,
    PLACE_V,
    PLACE_Y,
    QUADRATIC,
    REGIME,
    REMAINING,
    SINCE_BOUNDARY,
    SINCE_SEGMENT,
    STEPS,
    TAKEN,
    B,
    Y,
)

PENDING, ENDED = WIDEST, WIDEST + 1
PROGRESS = WIDEST + 2
"""Size of the array of whole numbers in which the progress of an interrupted sweep is kept.

First the index of the run in each lane, -1 for none; then the next run of the list, and the lanes
whose runs are over, as bits.
"""


@inner
def highest_power(like, work):
    """Return the highest power of v in the damping that acts in some lane."""
    zero = spread(like, 0.0)
    if any_lane(~(load(like, work, CUBIC) == zero)):
        return 3
    return 2 if any_lane(~(load(like, work, QUADRATIC) == zero)) else 1


@inner
def take_step(like, work):
    """Move every lane to the end of its step."""
    zero = spread(like, 0.0)
    duration = load(like, work, TAKEN)
    turned = load(like, work, EVENT) == spread(like, TURNED)
    if any_lane(turned | (load(like, work, EVENT) == spread(like, CROSSED))):
        y, v = evaluate_with_slope(like, work, Y, duration)
        # v is 0 at a turning point, to the last bit.
        v = select(turned, zero, v)
    else:
        # The last place of the step is its end: the same numbers, without evaluation.
        y, v = load(like, work, PLACE_Y + N_PLACES - 1), load(like, work, PLACE_V + N_PLACES - 1)
    b, rate = evaluate_with_slope(like, work, B, duration)
    store(work, Y, y)
    store(work, Y + 1, v)
    store(work, B, b)
    store(work, B + 1, rate)
    since_stop = load(like, work, SINCE_SEGMENT) + duration
    store(work, SINCE_SEGMENT, since_stop)
    store(work, REMAINING, load(like, work, LENGTH) - since_stop)
    store(work, SINCE_BOUNDARY, load(like, work, SINCE_BOUNDARY) + duration)
    store(work, STEPS, load(like, work, STEPS) + 1.0)
    kept = load(like, work, KEPT) * duration
    regime = load(like, work, REGIME)
    lost = select(regime == spread(like, CONTACT_LOSS), kept, zero)
    inverse = select(regime == spread(like, INVERSE_MESH), kept, zero)
    store(work, LOSS_TIME, load(like, work, LOSS_TIME) + lost)
    store(work, INVERSE_TIME, load(like, work, INVERSE_TIME) + inverse)


@inner
def settle(like, work, indices, summaries, strobes):
    """Follow what ended the steps; return the lanes whose runs are over, as bits."""
    width = width_of(like)
    event = load(like, work, EVENT)
    crossed = event == spread(like, CROSSED)
    ended = (event == spread(like, SEGMENT_ENDED)) | ~(
        load(like, work, REMAINING) > spread(like, 0.0)
    )
    if any_lane(crossed):
        cross_level(like, work, crossed)
    if any_lane(ended):
        waiting = lane_bits(next_segment(like, work, ended))
        while waiting:
            lane = lowest_bit(waiting)
            waiting &= waiting - 1
            pass_boundary(work, width, lane, indices[lane], summaries, strobes)
    if any_lane(crossed | ended):
        enter(like, work)
    # Negated comparisons, so that a value that is not a number ends a run too.
    over = ~(magnitude(load(like, work, Y)) < load(like, work, FARTHEST))
    over = over | ~(load(like, work, STEPS) < load(like, work, MOST_STEPS))
    over = over | (load(like, work, PERIOD) >= load(like, work, PERIODS))
    return lane_bits(over & (load(like, work, LOAD) > spread(like, 0.0)))


@inner
def all_empty(indices):
    """Return whether no lane has a run; numba would compile `indices.max()` for a second."""
    empty = True
    for index in indices:
        empty = empty and index < 0
    return empty


@inner
def sweep(
    like, work, runs, summaries, strobes, extrema, samples, samples_per_period, progress, most_turns
):
    """Integrate all `runs` (see `records.RUN`); results stand at the index of the run.

    Parameters
    ----------
    like : lanes
    work : pointer
        N_ROWS rows of as many elements as there are lanes, best aligned to one row.
    runs, summaries : ndarray of `records.RUN` and `records.SUMMARY`, shape (n,)
    strobes : ndarray, shape (n, periods + 1, 2)
    extrema : ndarray of `EXTREMUM`, shape (l, capacity)
        Of the first l runs. Those beyond the capacity are counted, not kept.
    samples : ndarray, shape (m, SAMPLED, row)
        Of the first m runs; a row has room for `WIDEST` more than it holds.
    samples_per_period : int
    progress : ndarray of int64, shape (PROGRESS,)
        Progress of the sweep. Before the first call: no runs in the lanes, and all of them ended.
    most_turns : int
        Steps of all lanes after which the sweep returns, to be called again.

    Returns
    -------
    bool
        Whether all runs are over.
    """
    width = width_of(like)
    indices = progress[:width]
    ended = progress[ENDED]
    turns = 0
    while turns < most_turns:
        # A lane takes the next run as soon as it has none.
        while ended:
            lane = lowest_bit(ended)
            ended &= ended - 1
            if indices[lane] >= 0:
                finish(work, width, lane, summaries[indices[lane]])
            if progress[PENDING] < runs.size:
                indices[lane] = progress[PENDING]
                begin(work, width, lane, runs, summaries, strobes, indices[lane])
                progress[PENDING] += 1
            else:
                indices[lane] = -1
                idle(work, width, lane)
            if not ended:
                enter(like, work)
                if all_empty(indices):
                    return True
        turn(like, work, runs, indices, summaries, extrema)
        expand(like, work, highest_power(like, work))
        choose_step(like, work)
        find_event(like, work)
        if any_lane(load(like, work, KEPT) > spread(like, 0.0)):
            integrate_square(like, work)
            for lane in range(width):
                index = indices[lane]
                if 0 <= index < samples.shape[0]:
                    sample(work, width, lane, runs[index], samples[index], samples_per_period)
        take_step(like, work)
        ended = settle(like, work, indices, summaries, strobes)
        turns += 1
    progress[ENDED] = ended
    return False
