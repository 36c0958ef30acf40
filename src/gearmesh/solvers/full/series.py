"""Taylor series of the motion in one step: the operations of a tape, order by order.

Between two jumps every law of `gearmesh.model.motion` is analytic along the motion. The coefficient
of order k of the forces gives that of order k + 2 of the coordinates.
"""

import numpy as np

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.solvers.compilation import inner
from gearmesh.solvers.full.roots import MAX_DEGREE
from gearmesh.solvers.full.tape import (
    ACCELERATE,
    BRACKET,
    CONSTANT,
    CONTACT,
    DEPTH,
    ENTRY,
    FACTORS,
    GAP,
    MOVES,
    N_BRANCHES,
    POWER,
    PRESSING,
    PRODUCT,
    ROOT,
    ROUND,
    SIGNED,
    SIGNS,
    SUMMANDS,
    TIME,
    WAVE,
    V,
    Y,
)

CASE = np.dtype(
    [
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
"""What the kernel needs of a run beside its tape, and the settings of the solver.

`masses` are those of both bodies, and `pulls` the stiffness and damping of their bearings across
the mesh line. `segments` is the number of segments in a mesh period.
"""

SEGMENT = np.dtype([("end", np.float64), ("gamma", np.float64), ("pairs", np.int64)])
"""A segment of the mesh period (`gearmesh.model.segments`).

`end` is its end in tau_s from the boundary of the period, `gamma` is summed over the pairs, whose
number is `pairs`.
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

INVERSE = np.array([0.0] + [1.0 / k for k in range(1, MAX_DEGREE + 3)])
"""1 / k; the compiled code divides by no number that could be 0."""

SIX, ONE = np.uint64(6), np.uint64(1)
"""Rows are counted without a sign, so that an index needs no check."""

NEW, CONTINUED, UNDER_WAY = range(3)
"""Stages of a run."""


@inner
def level(case, regime, direction):
    """Return the value of y at which motion in `direction` leaves the regime.

    A backlash that varies with time has no such level at the back flanks, and pairs of teeth that
    touch singly have none at the front flanks.
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
def _carry_out(mode, tape, forces, end, motion, motion_end, ahead, start, stop, series):
    """Carry out two ranges of operations for the coefficients of order `start` to before `stop`.

    The second range, from `motion` on, follows `ahead` orders ahead of the first.
    """
    operations, numbers, _ = tape
    direction = mode.direction
    for k_forces in range(start, stop):
        for part in range(2):
            first, last, k = (forces, end, k_forces)
            if part == 1:
                first, last, k = (motion, motion_end, k_forces + ahead)
            for i in range(first, last):
                code, out = operations[i, 0], operations[i, 1]
                one, two = operations[i, 2], operations[i, 3]
                total = 0.0
                if code <= ACCELERATE:
                    if k == 0:
                        total = numbers[i, 0]
                    for j in range(two):
                        row = operations[i, SUMMANDS + j]
                        total += numbers[i, FACTORS + j] * series[row, k]
                    if code == ACCELERATE:
                        total *= INVERSE[k + 1]
                        series[out + SIX, k + 1] = total
                        series[out, k + 2] = total * INVERSE[k + 2]
                    else:
                        series[out, k] = total
                        if code == MOVES and k > 0:
                            series[out + ONE, k - 1] = k * total
                elif code <= SIGNED:
                    for j in range(min(k, operations[i, 4]) + 1):
                        total += series[one, j] * series[two, k - j]
                    series[out, k] = total if code == PRODUCT else total * direction
                elif code == WAVE:
                    if k == 0:
                        angle = numbers[i, 1] * series[TIME, 0] + numbers[i, 0]
                        series[out, 0], series[out + ONE, 0] = np.sin(angle), np.cos(angle)
                    else:
                        scale = numbers[i, 1] * series[TIME, 1] * INVERSE[k]
                        series[out, k] = scale * series[out + ONE, k - 1]
                        series[out + ONE, k] = -scale * series[out, k - 1]
                elif code == ROUND:
                    series[out, k] = np.round(series[one, 0]) if k == 0 else 0.0
                elif code == ENTRY:
                    if k == 0:
                        place = np.int64(np.round(series[one, 0])) % np.int64(two)
                        total = numbers[i, FACTORS + place]
                    series[out, k] = total
                elif code == ROOT:
                    _root(series, out, one, k)
                elif code == POWER:
                    _power(series, out, one, numbers[i, 0], k)
                else:
                    _sine(series, out, one, k)


@inner
def _sine(series, out, angle, k):
    """Add the k-th coefficients of the sine and cosine of an angle whose k-th is there."""
    if k == 0:
        series[out, 0], series[out + ONE, 0] = np.sin(series[angle, 0]), np.cos(series[angle, 0])
        return
    s = c = 0.0
    for j in range(1, k + 1):
        s += j * series[angle, j] * series[out + ONE, k - j]
        c += j * series[angle, j] * series[out, k - j]
    series[out, k], series[out + ONE, k] = s / k, -c / k


@inner
def _root(series, out, square, k):
    """Add the k-th coefficient of the square root of a series."""
    if k == 0:
        series[out, 0] = np.sqrt(series[square, 0])
        return
    rest = series[square, k]
    for j in range(1, k):
        rest -= series[out, j] * series[out, k - j]
    series[out, k] = rest / (2.0 * series[out, 0])


@inner
def _power(series, out, base, exponent, k):
    """Add the k-th coefficient of a power of a series that begins with a positive number."""
    if k == 0:
        series[out, 0] = series[base, 0] ** exponent
        return
    total = 0.0
    for j in range(k):
        total += (exponent * (k - j) - j) * series[base, k - j] * series[out, j]
    series[out, k] = total * INVERSE[k] / series[base, 0]


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
def _places(case, mode, tape, variant):
    """Return where the operations of the branch begin: of y, the accelerations, the outputs."""
    branch = branch_of(case, mode, variant)
    return tape[2][branch, 0], tape[2][branch, 1], tape[2][branch, 2]


@inner
def begin(case, mode, state, tape, variant, series):
    """Write the first terms of the series: the state, time, and y and y'."""
    periods = case.start_period + mode.period + case.initial_phase
    series[TIME, 0] = periods + mode.time / case.period
    series[TIME, 1] = 1.0 / case.period
    series[CONSTANT, 0] = 1.0
    for i in range(case.coordinates):
        series[i, 0], series[i, 1] = state[i], state[6 + i]
        series[6 + i, 0] = state[6 + i]
    motion, forces, _ = _places(case, mode, tape, variant)
    _carry_out(mode, tape, 0, 0, motion, forces, 0, 0, 2, series)
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
    motion, forces, outputs = _places(case, mode, tape, variant)
    series[SIGNS, 0] = mode.run_out_sign * mode.slip_sign
    for j in range(3):
        series[PRESSING + j, 0] = mode.pressing[j]
    _carry_out(mode, tape, forces, outputs, motion, forces, 2, 0, order - 1, series)
    if mode.on_force:
        series[CONTACT, 0] = 0.0


@inner
def expand_outputs(case, mode, tape, variant, sampled, series):
    """Fill the series of the normal force and, if wanted, of all that is sampled."""
    branch = branch_of(case, mode, variant)
    first, last = tape[2][branch, 2], tape[2][branch, 4 if sampled else 3]
    _carry_out(mode, tape, first, last, 0, 0, 0, 0, case.order - 1, series)
