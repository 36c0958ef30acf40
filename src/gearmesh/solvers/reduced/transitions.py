"""Changes after an event: the next regime beyond a level, the next segment of the mesh period.

One instruction treats all lanes; masks select those in which the event has happened. The rows of a
lane afterwards depend only on its regime, its segment and its run.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.operations import select, spread
from gearmesh.solvers.lanes.rows import load, store
from gearmesh.solvers.reduced.workspace import (
    BACKLASH,
    CONTACT_LOSSES,
    CUBIC,
    ELASTIC,
    FRICTION,
    GUARD,
    KEPT,
    LENGTH,
    LEVEL_ABOVE,
    LEVEL_BELOW,
    LINEAR,
    LUBRICANT,
    MATERIAL,
    MAX_SEGMENTS,
    OFFSET,
    PERIOD,
    QUADRATIC,
    REGIME,
    REMAINING,
    SEGMENT,
    SEGMENT_FRICTION,
    SEGMENT_LENGTH,
    SEGMENT_STIFFNESS,
    SEGMENTS,
    SIGN,
    SINCE_BOUNDARY,
    SINCE_SEGMENT,
    Y,
)


@inner(inline="never")
def cross_level(like, work, crossed):
    """Change the regime of the lanes in `crossed` and put their y on the level exactly."""
    zero = spread(like, 0.0)
    regime = load(like, work, REGIME)
    lost = regime == spread(like, CONTACT_LOSS)
    rising = (lost & (load(like, work, SIGN) > zero)) | (regime == spread(like, INVERSE_MESH))
    level = select(rising, load(like, work, LEVEL_ABOVE), load(like, work, LEVEL_BELOW))
    store(work, Y, select(crossed, level, load(like, work, Y)))
    flank = select(rising, spread(like, NORMAL_MESH), spread(like, INVERSE_MESH))
    following = select(lost, flank, spread(like, CONTACT_LOSS))
    store(work, REGIME, select(crossed, following, regime))
    losses = load(like, work, CONTACT_LOSSES)
    loses = crossed & ~lost
    store(work, CONTACT_LOSSES, select(loses, losses + load(like, work, KEPT), losses))


@inner(inline="never")
def next_segment(like, work, ended):
    """Take the lanes in `ended` to their next segment; return those that begin a period."""
    zero = spread(like, 0.0)
    segment = load(like, work, SEGMENT) + 1.0
    around = ended & (segment == load(like, work, SEGMENTS))
    segment = select(around, zero, segment)
    store(work, SEGMENT, select(ended, segment, load(like, work, SEGMENT)))
    period = load(like, work, PERIOD)
    store(work, PERIOD, select(around, period + 1.0, period))
    since = load(like, work, SINCE_BOUNDARY)
    store(work, SINCE_BOUNDARY, select(around, zero, since))
    store(work, SINCE_SEGMENT, select(ended, zero, load(like, work, SINCE_SEGMENT)))
    length = select(ended, _of_segment(like, work, SEGMENT_LENGTH), load(like, work, LENGTH))
    store(work, LENGTH, length)
    store(work, REMAINING, select(ended, length, load(like, work, REMAINING)))
    return around


@inner(inline="always")
def _of_segment(like, work, rows):
    """Return what belongs to the segment of each lane, out of MAX_SEGMENTS rows."""
    segment = load(like, work, SEGMENT)
    value = load(like, work, rows)
    for i in range(1, MAX_SEGMENTS):
        value = select(segment == spread(like, float(i)), load(like, work, rows + i), value)
    return value


@inner(inline="never")
def enter(like, work):
    """Write the coefficients and levels that belong to each lane's regime and segment."""
    zero = spread(like, 0.0)
    far = spread(like, np.inf)
    regime = load(like, work, REGIME)
    lost = regime == spread(like, CONTACT_LOSS)
    normal = regime == spread(like, NORMAL_MESH)
    back = -load(like, work, BACKLASH)
    store(work, ELASTIC, select(lost, zero, _of_segment(like, work, SEGMENT_STIFFNESS)))
    store(work, FRICTION, _of_segment(like, work, SEGMENT_FRICTION))
    store(work, OFFSET, select(regime == spread(like, INVERSE_MESH), back, zero))
    for power, row in enumerate((LINEAR, QUADRATIC, CUBIC)):
        law = select(lost, load(like, work, LUBRICANT + power), load(like, work, MATERIAL + power))
        store(work, row, law)
    store(work, LEVEL_ABOVE, select(normal, far, select(lost, zero, back)))
    store(work, LEVEL_BELOW, select(normal, zero, select(lost, back, -far)))
    # Turning points matter where they are kept, and where |v| v bends the damping.
    kept = load(like, work, KEPT) > zero
    watches_v = lost | kept | ~(load(like, work, QUADRATIC) == zero)
    store(work, GUARD, select(watches_v, zero, regime))
