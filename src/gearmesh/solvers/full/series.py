"""Taylor series of the motion in one step: the operations of a tape, order by order.

Between two jumps every law of `gearmesh.model.motion` is analytic along the motion. The coefficient
of order k of the forces gives that of order k + 2 of the coordinates.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.recurrences import (
    FORCES,
    MOTION,
    N_PARTS,
    NORMAL_FORCE,
    SAMPLED,
    carry_out,
)
from gearmesh.solvers.full.speeds import write_phase
from gearmesh.solvers.full.tape import (
    BRACKET,
    CONSTANT,
    CONTACT,
    DEPTH,
    GAP,
    N_BRANCHES,
    PRESSING,
    SIGNS,
    TIME,
    V,
    Y,
)
from gearmesh.solvers.lanes.rows import pointer_to

CASE = np.dtype(
    [
        ("nu", np.float64),
        ("acceleration", np.float64),
        ("period", np.float64),
        ("initial_phase", np.float64),
        ("backlash", np.float64),
        ("varying_backlash", np.bool_),
        ("non_adhesive", np.bool_),
        ("single_pairs", np.bool_),
        ("friction", np.float64),
        ("follows_run_out", np.bool_),
        ("masses", np.float64, 2),
        ("pulls", np.float64, (2, 2)),
        ("coordinates", np.int64),
        ("acting", np.int64),
        ("segments", np.int64),
        ("start_period", np.int64),
        ("periods", np.int64),
        ("first_kept", np.int64),
        ("tolerance", np.float64),
        ("longest_step", np.float64),
        ("order", np.int64),
        ("farthest", np.float64),
        ("most_steps", np.float64),
    ]
)
"""Data of a run that the kernel needs besides the tape, and the settings of the solver.

`masses` are those of both bodies, and `pulls` the stiffness and damping of their bearings across
the mesh line. `acting` counts the coordinates that y depends on, and `segments` the segments in a
mesh period.
"""

SEGMENT = np.dtype([("end", np.float64), ("gamma", np.float64), ("pairs", np.int64)])
"""A segment of the mesh period (`gearmesh.model.segments`).

`end` is the time of its end in tau_s, from the start of the period. `pairs` is the number of pairs
of teeth in contact, and `gamma` the sum of gamma over them.
"""

MODE = np.dtype(
    [
        ("stage", np.int64),
        ("period", np.int64),
        ("segment", np.int64),
        ("time", np.float64),
        ("regime", np.int64),
        ("direction", np.float64),
        ("run_out_sign", np.float64),
        ("slip_sign", np.float64),
        ("parted", np.bool_),
        ("level", np.float64),
        ("turns", np.bool_),
        ("on_level", np.bool_),
        ("on_bracket", np.bool_),
        ("released", np.bool_),
        ("on_gap", np.bool_),
        ("on_force", np.bool_),
        ("entered", np.bool_),
        ("pressing", np.float64, 3),
        ("on_pair", np.float64, 3),
    ]
)
"""State of a run within its period: `time` since its boundary, and the branch of every law.

`stage` states whether the run is new, is continued with known branches, or is under way.
`direction` is the sign of y' (0 before the first motion) and `level` the value of y passed last.
`turns`, `on_level`, `on_bracket`, `on_gap` and `on_force` state that y', y - `level`, the bracket
of eq. (6), y + s(t) and the contact force are exactly 0, whatever rounding has left of them in the
coordinates. `released` states that sticking has just ended, and `entered` that a segment has
just begun. Where pairs of teeth touch singly, `pressing` is 1 for each that presses and `on_pair`
for each whose depth is exactly 0.
"""

NEW, CONTINUED, UNDER_WAY = range(3)
"""Stages of a run."""


@inner
def level(case, regime, direction):
    """Return the value of y at which motion in `direction` leaves the regime.

    It is infinite where there is no constant level: at the back flanks if the backlash varies, and
    at the front flanks if pairs of teeth touch singly.
    """
    meets_front = regime == NORMAL_MESH or (regime == CONTACT_LOSS and direction > 0.0)
    if case.single_pairs and meets_front:
        return direction * np.inf
    if direction > 0.0:
        if regime == INVERSE_MESH:
            return np.inf if case.varying_backlash else -case.backlash
        return 0.0 if regime == CONTACT_LOSS else np.inf
    if regime == INVERSE_MESH:
        return -np.inf
    if regime == CONTACT_LOSS:
        return -np.inf if case.varying_backlash else -case.backlash
    return 0.0


@inner
def branch_of(case, mode, variant):
    """Return the place of the branch that acts, in a period of the kind `variant`."""
    place = N_BRANCHES * (variant * case.segments + mode.segment)
    place += (mode.regime + 1) * 4
    if case.follows_run_out and mode.slip_sign == 0.0:
        place += 2
    if mode.parted:
        place += 1
    return place


@inner
def _carry_out(mode, tape, branch, part, start, stop, series):
    """Carry out one part of a branch for the orders from `start` up to, not including, `stop`."""
    numbers, branches = tape
    address, place = branches[branch, part], branches[branch, N_PARTS + part]
    rows = pointer_to(series)
    carry_out(address, rows, pointer_to(numbers), place, mode.direction, start, stop)


@inner
def begin(case, mode, state, tape, variant, series):
    """Write the first terms of the series: the state, time, and y and y'."""
    write_phase(case, mode, series[TIME])
    series[CONSTANT, 0] = 1.0
    for i in range(case.coordinates):
        series[i, 0], series[i, 1] = state[i], state[6 + i]
        series[6 + i, 0] = state[6 + i]
    _carry_out(mode, tape, branch_of(case, mode, variant), MOTION, 0, 2, series)
    if mode.on_level:
        series[Y, 0] = mode.level
    if mode.turns:
        series[V, 0] = 0.0
    if mode.on_bracket:
        series[BRACKET, 0] = 0.0
    if mode.on_gap:
        series[GAP, 0] = 0.0
    for j in range(3):
        if mode.on_pair[j] != 0.0 and not mode.entered:
            series[DEPTH + j, 0] = 0.0


@inner
def expand(case, mode, tape, variant, series, order):
    """Fill the series up to `order`, from what `begin` wrote."""
    series[SIGNS, 0] = mode.run_out_sign * mode.slip_sign
    for j in range(3):
        series[PRESSING + j, 0] = mode.pressing[j]
    _carry_out(mode, tape, branch_of(case, mode, variant), FORCES, 0, order - 1, series)
    if mode.on_force:
        series[CONTACT, 0] = 0.0


@inner
def expand_outputs(case, mode, tape, variant, sampled, series):
    """Fill the series of the normal force and, if `sampled`, of the other sampled quantities."""
    branch = branch_of(case, mode, variant)
    _carry_out(mode, tape, branch, NORMAL_FORCE, 0, case.order - 1, series)
    if sampled:
        _carry_out(mode, tape, branch, SAMPLED, 0, case.order - 1, series)
