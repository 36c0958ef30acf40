"""Instructions for the Taylor coefficients of one order, operation by operation.

The terms of a product that are known from earlier orders are added first, so only the last
additions wait for the newest coefficients. Every operation is an IEEE operation, and fused
multiply-adds are explicit, so all processors give the same bits.
"""

from collections.abc import Sequence
from typing import Any

from llvmlite import ir

from gearmesh.solvers.full.roots import WIDTH
from gearmesh.solvers.full.tape import (
    ACCELERATE,
    ENTRY,
    MOVES,
    POWER,
    PRODUCT,
    RATES,
    ROOT,
    ROUND,
    SIGNED,
    SINE,
    SUMS,
    TIME,
    WAVE,
)
from gearmesh.solvers.lanes.types import DOUBLE, INT64, call_llvm

Shape = tuple[int, int, tuple[int, ...], int]
"""An operation without its numbers.

Its items are the code of the operation, the row that it writes, the rows that it takes, and how
many numbers it has.
"""


class _Order:
    """Instructions for the coefficients of one order `k`."""

    def __init__(self, builder: ir.IRBuilder, arguments: Sequence[ir.Value], k: ir.Value) -> None:
        self.builder = builder
        self.series, self.numbers, self.direction = arguments[:3]
        self.k = k
        self.now = builder.gep(self.series, [k])
        self._inverses: dict[int, ir.Value] = {}

    def _shifted(self, by: int) -> ir.Value:
        return self.builder.add(self.k, ir.Constant(INT64, by))

    def _place(self, column: ir.Value, row: int, by: int) -> ir.Value:
        # Offsets that are constant become part of the instruction that loads or stores.
        return self.builder.gep(column, [ir.Constant(INT64, row * WIDTH + by)])

    def _load(self, row: int, by: int = 0) -> ir.Value:
        """Return the coefficient of order k + `by` of the series in `row`."""
        return self.builder.load(self._place(self.now, row, by))

    def _low(self, row: int, order: int = 0) -> ir.Value:
        """Return the coefficient of order `order` of the series in `row`."""
        return self.builder.load(self._place(self.series, row, order))

    def _store(self, row: int, value: ir.Value, by: int = 0) -> None:
        self.builder.store(value, self._place(self.now, row, by))

    def _number(self, i: int) -> ir.Value:
        return self.builder.load(self.builder.gep(self.numbers, [ir.Constant(INT64, i)]))

    def _real(self, k: ir.Value) -> ir.Value:
        return self.builder.sitofp(k, DOUBLE)

    def _fma(self, a: ir.Value, b: ir.Value, c: ir.Value) -> ir.Value:
        return call_llvm(self.builder, "fma", a, b, c)

    def _share(self, value: ir.Value, by: int) -> ir.Value:
        """Return `value` / (k + by)."""
        if by not in self._inverses:
            order = self._real(self._shifted(by))
            self._inverses[by] = self.builder.fdiv(_real(1.0), order)
        return self.builder.fmul(value, self._inverses[by])

    def _sum(self, total: ir.Value, rows: tuple[int, ...], first_number: int) -> ir.Value:
        for i, row in enumerate(rows):
            total = self._fma(self._number(first_number + i), self._load(row), total)
        return total

    def _write_sum(self, code: int, out: int, total: ir.Value) -> None:
        if code == ACCELERATE:
            rate = self._share(total, 1)
            self._store(RATES + out, rate, 1)
            self._store(out, self._share(rate, 2), 2)
        else:
            self._store(out, total)


def _real(value: float) -> ir.Value:
    return ir.Constant(DOUBLE, value)


class First(_Order):
    """Instructions for the coefficients of order 0."""

    def __init__(self, builder: ir.IRBuilder, arguments: Sequence[ir.Value]) -> None:
        super().__init__(builder, arguments, ir.Constant(INT64, 0))

    def emit(self, operations: Sequence[Shape]) -> None:
        """Write the instructions of all operations, in their order."""
        at = 0
        for code, out, rows, many in operations:
            if code in SUMS:
                self._write_sum(code, out, self._sum(self._number(at), rows, at + 1))
            elif code in (WAVE, SINE):
                if code == WAVE:
                    angle = self._fma(self._number(at + 1), self._low(TIME), self._number(at))
                else:
                    angle = self._low(rows[0])
                self._store(out, call_llvm(self.builder, "sin", angle))
                self._store(out + 1, call_llvm(self.builder, "cos", angle))
            elif code in (ROOT, ROUND):
                function = "sqrt" if code == ROOT else "rint"
                self._store(out, call_llvm(self.builder, function, self._low(rows[0])))
            elif code == POWER:
                value = call_llvm(self.builder, "pow", self._low(rows[0]), self._number(at))
                self._store(out, value)
            elif code == ENTRY:
                self._store(out, self._entry(rows[0], at, many))
            else:
                value = self.builder.fmul(self._low(rows[0]), self._low(rows[1]))
                if code == SIGNED:
                    value = self.builder.fmul(value, self.direction)
                self._store(out, value)
            at += many

    def _entry(self, row: int, first: int, size: int) -> ir.Value:
        """Return the entry of a table of `size` numbers at the whole number in `row`.

        The table begins at the number `first`, and repeats.
        """
        place = self.builder.fptosi(call_llvm(self.builder, "rint", self._low(row)), INT64)
        length = ir.Constant(INT64, size)
        # srem gives a negative remainder for a negative place.
        place = self.builder.srem(place, length)
        place = self.builder.srem(self.builder.add(place, length), length)
        place = self.builder.add(place, ir.Constant(INT64, first))
        return self.builder.load(self.builder.gep(self.numbers, [place]))


class Further(_Order):
    """Instructions for the coefficients of order 1 or higher."""

    def emit(self, operations: Sequence[Shape]) -> None:
        """Write the instructions of all operations, in their order."""
        pairs = [pair for operation in operations for pair in _convolved(operation)]
        self.middles = self._convolutions(pairs)
        at = 0
        for code, out, rows, many in operations:
            if code in SUMS:
                total = self._sum(_real(0.0), rows, at + 1)
                self._write_sum(code, out, total)
                if code == MOVES:
                    rate = self.builder.fmul(self._real(self.k), total)
                    self._store(out + 1, rate, -1)
            elif code == WAVE:
                speed = self.builder.fmul(self._number(at + 1), self._low(TIME, 1))
                self._turn(out, self._share(speed, 0))
            elif code == SINE:
                self._sine(out, rows[0])
            elif code in (ROUND, ENTRY):
                self._store(out, _real(0.0))
            elif code == ROOT:
                self._root(out, rows[0])
            elif code == POWER:
                self._power(out, rows[0], self._number(at))
            else:
                self._product(code, out, *rows)
            at += many

    def _convolutions(self, pairs: list[tuple[int, int, bool]]) -> dict[Any, ir.Value]:
        """Return the sum of a_j b_(k-j), or of j a_j b_(k-j), over 0 < j < k for each pair."""
        if not pairs:
            return {}
        builder = self.builder
        before = builder.block
        loop = builder.append_basic_block()
        after = builder.append_basic_block()
        last = self._shifted(-2)
        two, zero = ir.Constant(INT64, 2), _real(0.0)
        builder.cbranch(builder.icmp_signed("<=", two, last), loop, after)
        builder.position_at_end(loop)
        j = builder.phi(INT64)
        j.add_incoming(two, before)
        sums = []
        for a, b, weighted in pairs:
            total = builder.phi(DOUBLE)
            total.add_incoming(zero, before)
            sums.append((total, a, b, weighted))
        behind = builder.gep(self.series, [j])
        ahead = builder.gep(self.series, [builder.sub(self.k, j)])
        totals = []
        for total, a, b, weighted in sums:
            factor = builder.load(self._place(behind, a, 0))
            if weighted:
                factor = builder.fmul(self._real(j), factor)
            totals.append(self._fma(factor, builder.load(self._place(ahead, b, 0)), total))
        following = builder.add(j, ir.Constant(INT64, 1))
        j.add_incoming(following, loop)
        for (total, *_), new in zip(sums, totals, strict=True):
            total.add_incoming(new, loop)
        builder.cbranch(builder.icmp_signed("<=", following, last), loop, after)
        builder.position_at_end(after)
        middles = []
        for new in totals:
            total = builder.phi(DOUBLE)
            total.add_incoming(zero, before)
            total.add_incoming(new, loop)
            middles.append(total)
        found: dict[Any, ir.Value] = {}
        masks = [
            builder.uitofp(builder.icmp_signed(">", self.k, ir.Constant(INT64, order)), DOUBLE)
            for order in (1, 2)
        ]
        for pair, total in zip(pairs, middles, strict=True):
            a, b, weighted = pair
            first = builder.fmul(masks[0], self._low(a, 1))
            total = self._fma(first, self._load(b, -1), total)
            second = builder.fmul(masks[1], self._low(b, 1))
            if weighted:
                second = builder.fmul(second, self._real(self._shifted(-1)))
            found[pair] = self._fma(second, self._load(a, -1), total)
        return found

    def _product(self, code: int, out: int, a: int, b: int) -> None:
        total = self.middles[a, b, False]
        if a == b:
            doubled = self.builder.fmul(_real(2.0), self._low(a))
            total = self._fma(doubled, self._load(a), total)
        else:
            total = self._fma(self._low(b), self._load(a), total)
            total = self._fma(self._low(a), self._load(b), total)
        if code == SIGNED:
            total = self.builder.fmul(total, self.direction)
        self._store(out, total)

    def _turn(self, out: int, angle: ir.Value) -> None:
        """Continue sine and cosine of an angle that is linear in time."""
        self._store(out, self.builder.fmul(angle, self._load(out + 1, -1)))
        back = self.builder.fmul(self.builder.fneg(angle), self._load(out, -1))
        self._store(out + 1, back)

    def _sine(self, out: int, angle: int) -> None:
        newest = self.builder.fmul(self._real(self.k), self._load(angle))
        s = self._fma(newest, self._low(out + 1), self.middles[angle, out + 1, True])
        c = self._fma(newest, self._low(out), self.middles[angle, out, True])
        self._store(out, self._share(s, 0))
        self._store(out + 1, self.builder.fneg(self._share(c, 0)))

    def _root(self, out: int, square: int) -> None:
        rest = self.builder.fsub(self._load(square), self.middles[out, out, False])
        doubled = self.builder.fmul(_real(2.0), self._low(out))
        self._store(out, self.builder.fdiv(rest, doubled))

    def _power(self, out: int, base: int, exponent: ir.Value) -> None:
        # For p = b^e, k b_0 p_k is the sum of (e (k - j) - j) b_(k-j) p_j over j < k.
        whole = self._fma(self._load(base), self._low(out), self.middles[out, base, False])
        scale = self.builder.fmul(exponent, self._real(self.k))
        less = self.builder.fadd(exponent, _real(1.0))
        less = self.builder.fmul(less, self.middles[out, base, True])
        total = self.builder.fsub(self.builder.fmul(scale, whole), less)
        self._store(out, self.builder.fdiv(self._share(total, 0), self._low(base)))


def _convolved(operation: Shape) -> list[tuple[int, int, bool]]:
    """Return the pairs of series that an operation convolves, as `_convolutions` takes them.

    The third item of a pair states whether the first series is differentiated.
    """
    code, out, rows, _ = operation
    if code in (PRODUCT, SIGNED):
        return [(rows[0], rows[1], False)]
    if code == ROOT:
        return [(out, out, False)]
    if code == POWER:
        return [(out, rows[0], False), (out, rows[0], True)]
    if code == SINE:
        return [(rows[0], out + 1, True), (rows[0], out, True)]
    return []
