"""The equations of motion as a list of operations on Taylor coefficients.

`gearmesh.model.motion` is evaluated once for each branch of the laws with numbers that record what
is done with them. A sum of numbers stays a sum; a product, a sine, a square root become a row of
the table of series with an operation that gives its coefficient of order k from those of its
operands (Jorba and Zou, Experimental Mathematics 14, 2005). The compiled solver
(`gearmesh.solvers.full.series`) carries out the operations and knows no law.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.model import motion
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH
from gearmesh.model.flanks import distances
from gearmesh.model.problem import Problem
from gearmesh.model.stiffness import TURN
from gearmesh.solvers.full.coordinates import embedding, signs_act

COORDINATES, RATES = 0, 6
TIME, CONSTANT, SIGNS = range(12, 15)
Y, V, SWING, BRACKET, GAP, CONTACT, ELASTIC, FRICTION, STIFFNESS, NORMAL = range(15, 25)
TRANSMISSION = 25
BEARINGS = (26, 27, 28, 29)
PRESSING, DEPTH = 30, 33
FIRST_FREE = 36
"""Rows of the table of series.

The first six are the coordinates, the next six their rates. TIME counts mesh periods. CONSTANT
is 1, SIGNS the product of both signs of eq. (6). V and BRACKET are the rates of Y and
SWING. GAP is y + s(t). CONTACT and NORMAL are the fields `contact` and `normal` of
`gearmesh.model.mode.Forces`. TRANSMISSION is the transmission error. BEARINGS are the forces on the
bearings of wheels 3 and 2, first along the mesh line, then across it. PRESSING and DEPTH have three
rows each, one for each pair of teeth that may touch singly. PRESSING is 1 if the pair presses, and
0 if not. DEPTH is how deep the pair is in contact.
"""

SUM, MOVES, ACCELERATE, PRODUCT, SIGNED, WAVE, SINE, ROOT, ROUND, ENTRY, POWER = range(11)
"""Operations.

MOVES is a sum whose rate goes into the next row. ACCELERATE is a sum that gives an acceleration.
SIGNED is a product of two rows and the sign of y'. WAVE gives the sine and cosine of an angle that
is linear in time. ENTRY looks up a whole number in a table that repeats. POWER has a constant
exponent.
"""

Operation = tuple[int, int, tuple[Any, ...]]
"""The code of the operation, the row that it writes, and its operands.

The operands of a product are two rows. Those of a sum are its summands, each a row and a factor,
and a constant. WAVE takes the slope and the constant of its angle. ENTRY takes a row and a table,
and POWER a row and an exponent.
"""

SUMS = (SUM, MOVES, ACCELERATE)

N_BRANCHES = 12
"""Branches of a segment: three regimes, sticking or not, parted or not (`branch_of`)."""


class _Traced:
    """A sum of rows with factors, and a constant."""

    __slots__ = ("constant", "terms", "trace")
    __array_ufunc__ = None  # numpy numbers leave the arithmetic to this class

    def __init__(self, trace: "_Trace", terms: Mapping[int, float], constant: float = 0.0) -> None:
        self.trace, self.terms, self.constant = trace, terms, constant

    def __add__(self, other: Any) -> "_Traced":
        if not isinstance(other, _Traced):
            return _Traced(self.trace, self.terms, self.constant + float(other))
        terms = dict(self.terms)
        for row, factor in other.terms.items():
            total = terms.get(row, 0.0) + factor
            if total == 0.0:
                del terms[row]
            else:
                terms[row] = total
        return _Traced(self.trace, terms, self.constant + other.constant)

    def __mul__(self, other: Any) -> "_Traced":
        if isinstance(other, _Traced):
            return self.trace.product(self, other)
        factor = float(other)
        if factor == 0.0:
            return _Traced(self.trace, {})
        if factor == 1.0:
            return self
        terms = {row: factor * value for row, value in self.terms.items()}
        return _Traced(self.trace, terms, factor * self.constant)

    def __neg__(self) -> "_Traced":
        return self * -1.0

    def __sub__(self, other: Any) -> "_Traced":
        return self + -other

    def __rsub__(self, other: Any) -> "_Traced":
        return -self + other

    def __truediv__(self, number: float) -> "_Traced":
        return _Traced(
            self.trace,
            {row: value / number for row, value in self.terms.items()},
            self.constant / number,
        )

    __radd__, __rmul__ = __add__, __mul__

    def __abs__(self) -> "_Traced":
        if self.terms.keys() != {V} or self.constant != 0.0:
            raise TypeError("only the sign of y' is known: abs takes nothing else")
        return self.trace.modulus(V) * abs(self.terms[V])

    def __round__(self) -> "_Traced":
        return self.trace.single(ROUND, self)

    def entry(self, table: tuple[float, ...]) -> "_Traced":
        return self.trace.entry(table, self)

    def power(self, exponent: float) -> "_Traced":
        return self.trace.power(self, exponent)

    def sqrt(self) -> "_Traced":
        return self.trace.single(ROOT, self)

    def sin(self) -> "_Traced":
        return self.trace.wave(self)[0]

    def cos(self) -> "_Traced":
        return self.trace.wave(self)[1]


class _Trace:
    """The operations recorded so far, each only once.

    TIME is linear in time if the speed is `steady`.
    """

    def __init__(self, steady: bool) -> None:
        self.steady = steady
        self.operations: list[Operation] = []
        self._known: dict[tuple[Any, ...], int] = {}
        self._moduli: dict[int, int] = {}
        self._free = FIRST_FREE

    def row(self, row: int) -> _Traced:
        return _Traced(self, {row: 1.0})

    def _result(self, code: int, operands: tuple[Any, ...], rows: int = 1) -> int:
        key = (code, *operands)
        if key not in self._known:
            self._known[key] = out = self._free
            self._free += rows
            self.operations.append((code, out, operands))
        return self._known[key]

    def _row_of(self, terms: Mapping[int, float]) -> tuple[int, float]:
        """Return a row and a factor that together are a sum without a constant."""
        factor = next(iter(terms.values()))
        scaled = {row: value / factor for row, value in terms.items()}
        return self._row_exactly(_Traced(self, scaled)), factor

    def product(self, a: _Traced, b: _Traced) -> _Traced:
        rest = _Traced(self, b.terms) * a.constant + _Traced(self, a.terms) * b.constant
        rest += a.constant * b.constant
        if not a.terms or not b.terms:
            return rest
        (row_a, factor_a), (row_b, factor_b) = self._row_of(a.terms), self._row_of(b.terms)
        code = PRODUCT
        for row, other in ((row_a, row_b), (row_b, row_a)):
            if row in self._moduli:
                code, row_a, row_b = SIGNED, self._moduli[row], other
                break
        found = self._result(code, tuple(sorted((row_a, row_b))))
        return rest + _Traced(self, {found: factor_a * factor_b})

    def modulus(self, row: int) -> _Traced:
        """Return the absolute value of a number with the sign of y'."""
        found = self._result(SIGNED, (CONSTANT, row))
        self._moduli[found] = row
        return self.row(found)

    def _row_exactly(self, value: _Traced) -> int:
        """Return the row of a number."""
        if value.constant == 0.0 and list(value.terms.values()) == [1.0]:
            return next(iter(value.terms))
        operands = (tuple(sorted(value.terms.items())), value.constant)
        return self._result(SUM, operands)

    def single(self, code: int, value: _Traced) -> _Traced:
        """Return the result of an operation on one number."""
        return self.row(self._result(code, (self._row_exactly(value),)))

    def entry(self, table: tuple[float, ...], place: _Traced) -> _Traced:
        """Return the entry of `table` at the whole number `place`."""
        return self.row(self._result(ENTRY, (self._row_exactly(place), table)))

    def power(self, base: _Traced, exponent: float) -> _Traced:
        """Return a positive number to a constant power."""
        return self.row(self._result(POWER, (self._row_exactly(base), exponent)))

    def wave(self, angle: _Traced) -> tuple[_Traced, _Traced]:
        """Return sine and cosine of an angle."""
        if not angle.terms:
            return (
                _Traced(self, {}, float(np.sin(angle.constant))),
                _Traced(self, {}, float(np.cos(angle.constant))),
            )
        if self.steady and angle.terms.keys() == {TIME}:
            operands: tuple[Any, ...] = (angle.terms[TIME], angle.constant)
            out = self._result(WAVE, operands, rows=2)
        else:
            out = self._result(SINE, (self._row_exactly(angle),), rows=2)
        return self.row(out), self.row(out + 1)

    def name(self, row: int, value: Any, code: int = SUM) -> _Traced:
        """Give a traced number or a float a row of its own; with MOVES its rate has the next."""
        terms = value.terms if isinstance(value, _Traced) else {}
        constant = value.constant if isinstance(value, _Traced) else float(value)
        self.operations.append((code, row, (tuple(sorted(terms.items())), constant)))
        return self.row(row)


def branch_of(regime: int, sticks: bool, parted: bool) -> int:
    """Return the place of a branch among those of its segment."""
    return (regime + 1) * 4 + sticks * 2 + parted


def laws_of(problem: Problem) -> Problem:
    """Return `problem` with fixed values for all that its equations of motion do not contain.

    Time enters the laws only through the angles of the wheels. If time is counted in mesh periods,
    the laws are the same for all mesh frequencies, and for all that change.
    """
    final_nu = None if problem.final_nu is None else TURN
    return replace(
        problem,
        nu=TURN,
        final_nu=final_nu,
        revolutions=1,
        kept_revolutions=0,
        initial_state=None,
    )


def record(
    laws: Problem, segments: Iterable[float], sampled: bool = False
) -> list[list[list[Operation]]]:
    """Record the equations of motion.

    Parameters
    ----------
    laws : Problem
        From `laws_of`.
    segments : iterable of float
        A mesh phase in each segment.
    sampled : bool
        As for `gearmesh.solvers.full.coordinates.embedding`.

    Returns
    -------
    list
        One item for each of the `N_BRANCHES` branches of each segment. It contains four lists of
        operations: those of y, of the accelerations, of the normal force, and of the other sampled
        quantities. It is empty for a branch that cannot occur.
    """
    columns = embedding(laws, sampled)
    branches: list[list[list[Operation]]] = []
    signed = signs_act(laws)
    for segment in segments:
        found: list[list[list[Operation]]] = [[] for _ in range(N_BRANCHES)]
        for regime in (CONTACT_LOSS, NORMAL_MESH, INVERSE_MESH):
            can_part = laws.terms.non_adhesive and regime != CONTACT_LOSS
            for stick in (False, True) if signed else (False,):
                for parted in (False, True) if can_part else (False,):
                    mode = motion.Mode(regime, segment, 1, 0 if stick else 1, parted)
                    place = branch_of(regime, stick, parted)
                    found[place] = _record(laws, mode, columns, signed)
        branches += found
    return branches


def _record(
    problem: Problem, mode: motion.Mode, columns: np.ndarray, signed: bool
) -> list[list[Operation]]:
    """Return the operations of a branch in four parts, as `record` does."""
    trace = _Trace(steady=problem.final_nu is None)
    time = trace.row(TIME)
    n = columns.shape[1]
    q, v = (
        [
            _Traced(trace, {first + i: float(row[i]) for i in range(n) if row[i]})
            if row.any()
            else 0.0
            for row in columns
        ]
        for first in (COORDINATES, RATES)
    )
    y = trace.name(Y, motion.displacement(problem, time, q), MOVES)
    if signed:
        trace.name(SWING, motion.run_out_integral(problem, time, q), MOVES)
    if problem.terms.backlash_varies:
        trace.name(GAP, y + motion.gap(problem, time, q))
    if problem.terms.pairs_touch_singly:
        starts = distances(problem, motion.mesh_phase(problem, time), mode.segment)
        for j, start in enumerate(starts):
            trace.name(DEPTH + j, y - start)
        mode = replace(mode, pressing=tuple(trace.row(PRESSING + j) for j in range(len(starts))))
    moved = len(trace.operations)
    if signed and mode.slip_sign:
        mode = replace(mode, slip_sign=trace.row(SIGNS))
    mesh = motion.forces(problem, time, q, v, y, trace.row(V), mode)
    wanted = [Y, V, SWING, BRACKET, GAP, *range(DEPTH, DEPTH + 3)]
    if problem.terms.non_adhesive:
        trace.name(CONTACT, mesh.contact)
        wanted.append(CONTACT)
    if signed:
        trace.name(ELASTIC, mesh.elastic)
        trace.name(FRICTION, mesh.friction)
        wanted += [ELASTIC, FRICTION]
    six = motion.accelerations_under(problem, time, q, v, mesh)
    for i in range(n):
        total = sum(
            (six[j] * float(columns[j, i]) for j in range(6) if columns[j, i]),
            _Traced(trace, {}),
        ) / float(np.sum(columns[:, i] ** 2))
        operands = (tuple(sorted(total.terms.items())), total.constant)
        trace.operations.append((ACCELERATE, COORDINATES + i, operands))
    forced = len(trace.operations)
    if not signed:
        trace.name(FRICTION, mesh.friction)
    trace.name(STIFFNESS, mesh.stiffness)
    trace.name(NORMAL, mesh.normal)
    trace.name(TRANSMISSION, q[motion.ROTATION_3] + q[motion.ROTATION_2])
    for row, pull in zip(BEARINGS, motion.bearing_pulls(problem, q, v), strict=True):
        trace.name(row, pull)
    everything = trace.operations
    needed = _needed(everything[:forced], wanted)
    pressing = _needed(everything, [NORMAL]) - needed
    sampled = [*range(STIFFNESS, TRANSMISSION + 1), *BEARINGS, FRICTION]
    outputs = _needed(everything, sampled) - needed - pressing
    return [
        [everything[i] for i in sorted(needed) if i < moved],
        [everything[i] for i in sorted(needed) if i >= moved],
        [everything[i] for i in sorted(pressing)],
        [everything[i] for i in sorted(outputs)],
    ]


def _needed(operations: list[Operation], rows: Iterable[int]) -> set[int]:
    """Return the places of the operations that `rows` and the accelerations need."""
    wanted, found = set(rows), set()
    for i in range(len(operations) - 1, -1, -1):
        code, out, operands = operations[i]
        second = code in (WAVE, SINE) and out + 1 in wanted
        if code == ACCELERATE or out in wanted or second:
            found.add(i)
            if code in SUMS:
                wanted.update(row for row, _ in operands[0])
            elif code in (ENTRY, POWER):
                wanted.add(operands[0])
            elif code != WAVE:
                wanted.update(operands[:2])
    return found
