"""Input and output of the compiled sweep, and how a run enters and leaves a lane."""

import numpy as np

from gearmesh.model.contact import NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.lanes.rows import get, put
from gearmesh.solvers.reduced.workspace import (
    BACKLASH,
    BEARING_DAMPING,
    BEARING_STIFFNESS,
    CONTACT_LOSSES,
    FARTHEST,
    FIRST_KEPT,
    INVERSE_TIME,
    KEPT,
    LENGTH,
    LOAD,
    LOG_TOLERANCE,
    LONGEST,
    LOSS_TIME,
    LUBRICANT,
    MATERIAL,
    MAX_SEGMENTS,
    MOST_STEPS,
    N_ROWS,
    PERIOD,
    PERIODS,
    REGIME,
    REMAINING,
    SEGMENT_FRICTION,
    SEGMENT_LENGTH,
    SEGMENT_STIFFNESS,
    SEGMENTS,
    SIGN,
    SQUARE_INTEGRAL,
    STEPS,
    TWO_MU,
    B,
    Y,
)
from gearmesh.solvers.response import DIVERGED, MEASURED, OK, STEP_LIMIT

RUN = np.dtype(
    [
        ("segments", np.float64),
        ("length", np.float64, MAX_SEGMENTS),
        ("stiffness", np.float64, MAX_SEGMENTS),
        ("friction", np.float64, MAX_SEGMENTS),
        ("sample_end", np.float64, MAX_SEGMENTS),
        ("period", np.float64),
        ("periods", np.float64),
        ("first_kept", np.float64),
        ("material", np.float64, 3),
        ("lubricant", np.float64, 3),
        ("backlash", np.float64),
        ("two_mu", np.float64),
        ("bearing_stiffness", np.float64),
        ("bearing_damping", np.float64),
        ("start", np.float64, 4),
        ("regime", np.float64),
        ("direction", np.float64),
        ("longest", np.float64),
        ("farthest", np.float64),
        ("most_steps", np.float64),
        ("log_tolerance", np.float64),
    ]
)
"""One run as the kernel takes it. Times are in tau_s, and whole numbers are stored as floats.

For each segment of a mesh period: its length, C/C_s, the share of the elastic force that friction
adds to u'', and the number of the first sample of the period behind it. `start` is (y, y', b, b'),
`direction` the sign of y', 0 if it is not known.
"""

SUMMARY = np.dtype(
    [*MEASURED, ("final", np.float64, 4), ("regime", np.float64), ("direction", np.float64)]
)
"""What the kernel measures on a run, and `start`, `regime` and `direction` at its end."""


@inner
def take_value(summary, y):
    """Update y_max and y_min with `y`."""
    summary.y_max = max(summary.y_max, y)
    summary.y_min = min(summary.y_min, y)


@inner
def _record_strobe(strobes, index, boundary, y, v):
    strobes[index, boundary, 0] = y
    strobes[index, boundary, 1] = v


@inner
def begin(work, width, lane, runs, summaries, strobes, index):
    """Put run `index` into the lane; `transitions.enter` has to follow."""
    run = runs[index]
    for row in range(N_ROWS):
        put(work, width, row, lane, 0.0)
    y, v = run.start[0], run.start[1]
    put(work, width, Y, lane, y)
    put(work, width, Y + 1, lane, v)
    put(work, width, B, lane, run.start[2])
    put(work, width, B + 1, lane, run.start[3])
    put(work, width, REGIME, lane, run.regime)
    # Without a direction the first step is not taken for a turning point.
    put(work, width, SIGN, lane, run.direction)
    put(work, width, BACKLASH, lane, run.backlash)
    put(work, width, FARTHEST, lane, run.farthest)
    put(work, width, LOAD, lane, 1.0)
    put(work, width, TWO_MU, lane, run.two_mu)
    put(work, width, BEARING_STIFFNESS, lane, run.bearing_stiffness)
    put(work, width, BEARING_DAMPING, lane, run.bearing_damping)
    put(work, width, LOG_TOLERANCE, lane, run.log_tolerance)
    for power in range(3):
        put(work, width, MATERIAL + power, lane, run.material[power])
        put(work, width, LUBRICANT + power, lane, run.lubricant[power])
    for i in range(int(run.segments)):
        put(work, width, SEGMENT_LENGTH + i, lane, run.length[i])
        put(work, width, SEGMENT_STIFFNESS + i, lane, run.stiffness[i])
        put(work, width, SEGMENT_FRICTION + i, lane, run.friction[i])
    put(work, width, LONGEST, lane, run.longest)
    put(work, width, LENGTH, lane, run.length[0])
    put(work, width, REMAINING, lane, run.length[0])
    put(work, width, SEGMENTS, lane, run.segments)
    put(work, width, PERIODS, lane, run.periods)
    put(work, width, FIRST_KEPT, lane, run.first_kept)
    put(work, width, MOST_STEPS, lane, run.most_steps)
    if run.first_kept == 0:
        put(work, width, KEPT, lane, 1.0)
        take_value(summaries[index], y)
    _record_strobe(strobes, index, 0, y, v)


@inner
def idle(work, width, lane):
    """Mark the lane as empty: nothing moves in it, and it never ends."""
    for row in range(N_ROWS):
        put(work, width, row, lane, 0.0)
    put(work, width, REGIME, lane, NORMAL_MESH)
    put(work, width, FARTHEST, lane, np.inf)
    put(work, width, MOST_STEPS, lane, np.inf)
    put(work, width, LONGEST, lane, 1.0)
    put(work, width, LENGTH, lane, np.inf)
    put(work, width, REMAINING, lane, np.inf)


@inner
def pass_boundary(work, width, lane, index, summaries, strobes):
    """Record what belongs to the boundary of a mesh period."""
    period = get(work, width, PERIOD, lane)
    y = get(work, width, Y, lane)
    _record_strobe(strobes, index, int(period), y, get(work, width, Y + 1, lane))
    first_kept = get(work, width, FIRST_KEPT, lane)
    if period == first_kept and period < get(work, width, PERIODS, lane):
        put(work, width, KEPT, lane, 1.0)
        # Directions were not followed before, so a change here is no extremum.
        put(work, width, SIGN, lane, 0.0)
        take_value(summaries[index], y)


@inner
def finish(work, width, lane, summary):
    """Record what was measured on a run, and why it ends."""
    y, b = get(work, width, Y, lane), get(work, width, B, lane)
    summary.steps = int(get(work, width, STEPS, lane))
    # The negated comparison is true for a value that is not a number too.
    if not abs(y) + 0.0 * b < get(work, width, FARTHEST, lane):
        summary.status = DIVERGED
    elif get(work, width, PERIOD, lane) < get(work, width, PERIODS, lane):
        summary.status = STEP_LIMIT
    else:
        summary.status = OK
        take_value(summary, y)
        summary.contact_losses = int(get(work, width, CONTACT_LOSSES, lane))
        summary.square_integral = get(work, width, SQUARE_INTEGRAL, lane)
        summary.loss_time = get(work, width, LOSS_TIME, lane)
        summary.inverse_time = get(work, width, INVERSE_TIME, lane)
        summary.final[0], summary.final[1] = y, get(work, width, Y + 1, lane)
        summary.final[2], summary.final[3] = b, get(work, width, B + 1, lane)
        summary.regime = get(work, width, REGIME, lane)
        summary.direction = get(work, width, SIGN, lane)
