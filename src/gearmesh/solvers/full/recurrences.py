"""The operations of a tape as machine code.

Every branch of the laws becomes a few functions that fill the table of series, order by order. Two
branches whose operations differ in their numbers only share the code: the numbers are data. LLVM
translates it in some milliseconds, once in a process.

The terms of a product that were known an order earlier are added first, so that the sum waits for
the newest ones only. Every operation is an IEEE operation, with explicit fused multiply-adds, so
all processors give the same bits.
"""

from collections.abc import Iterable, Sequence
from functools import cache, lru_cache
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.extending import intrinsic

from gearmesh.model.problem import Problem
from gearmesh.solvers.full.roots import MAX_DEGREE
from gearmesh.solvers.full.tape import (
    ACCELERATE,
    ENTRY,
    FIRST_FREE,
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
    Operation,
    laws_of,
    record,
)
from gearmesh.solvers.lanes.rows import POINTER
from gearmesh.solvers.lanes.types import DOUBLE, INT64, call_llvm

_Shape = tuple[int, int, tuple[int, ...], int]
"""An operation without its numbers: what it does, the row that it writes, the rows that it takes,
and how many numbers it has."""

_WIDTH = MAX_DEGREE + 1
_POINTER = DOUBLE.as_pointer()
_ARGUMENTS = [_POINTER, _POINTER, DOUBLE, INT64, INT64]
_SIGNATURE = ir.FunctionType(ir.VoidType(), _ARGUMENTS)
_CONVOLVED = (PRODUCT, SIGNED, SINE, ROOT)


MOTION, FORCES, NORMAL_FORCE, SAMPLED = range(4)
"""Functions of a branch: y, the accelerations, the normal force, what else is sampled."""

N_PARTS = 4


class Recurrences(NamedTuple):
    """Recurrences of all branches of the laws, as the compiled solver takes them.

    Attributes
    ----------
    numbers : ndarray
        Numbers of the operations.
    branches : ndarray of int, shape (`N_BRANCHES` * segments, 8)
        Addresses of the four functions of a branch, and where their numbers begin; zeros for a
        branch that cannot occur.
    height : int
        Number of rows that the table of series needs.
    """

    numbers: np.ndarray
    branches: np.ndarray
    height: int


def recurrences(problem: Problem, segments: Iterable[float], sampled: bool) -> Recurrences:
    """Return the recurrences of a problem.

    Parameters
    ----------
    problem : Problem
    segments : iterable of float
        A mesh phase in each segment.
    sampled : bool
        Whether the function of what is sampled is wanted.
    """
    return _recurrences(laws_of(problem), tuple(segments), sampled)


@lru_cache(maxsize=256)
def _recurrences(laws: Problem, segments: tuple[float, ...], sampled: bool) -> Recurrences:
    numbers: list[float] = []
    branches = []
    height = FIRST_FREE
    for parts in record(laws, segments, sampled):
        if not parts:
            branches.append([0] * (2 * N_PARTS))
            continue
        places = []
        for part in parts:
            places.append(len(numbers))
            numbers += [number for operation in part for number in _numbers(operation)]
            height = max([height, *(out + 2 for _, out, _ in part)])
        places[FORCES] = places[MOTION]  # the accelerations continue y
        moves, *others = (tuple(_shape(operation) for operation in part) for part in parts)
        forces, presses, sample = others
        addresses = [_compiled(moves), _compiled(forces, moves), _compiled(presses)]
        addresses.append(_compiled(sample) if sampled else 0)
        branches.append(addresses + places)
    return Recurrences(np.array(numbers), np.array(branches, np.int64), height)


def _shape(operation: Operation) -> _Shape:
    code, out, operands = operation
    rows = operands
    if code in SUMS:
        rows = tuple(row for row, _ in operands[0])
    elif code == WAVE:
        rows = ()
    elif code in (ENTRY, POWER):
        rows = operands[:1]
    return code, out, rows, len(_numbers(operation))


def _numbers(operation: Operation) -> tuple[float, ...]:
    """Return the numbers of an operation; those of a sum or an angle begin with its constant."""
    code, _, operands = operation
    if code in SUMS:
        summands, constant = operands
        return constant, *(factor for _, factor in summands)
    if code == WAVE:
        slope, constant = operands
        return constant, slope
    if code == POWER:
        return operands[1:]
    return operands[1] if code == ENTRY else ()


class _Order:
    """Instructions for the coefficients of one order `k`."""

    def __init__(self, builder: ir.IRBuilder, arguments: Sequence[ir.Value], k: ir.Value) -> None:
        self.builder = builder
        self.series, self.numbers, self.direction = arguments[:3]
        self.k = k

    def shifted(self, by: int) -> ir.Value:
        return self.builder.add(self.k, ir.Constant(INT64, by))

    def place(self, row: int, k: ir.Value) -> ir.Value:
        at = self.builder.add(ir.Constant(INT64, row * _WIDTH), k)
        return self.builder.gep(self.series, [at])

    def load(self, row: int, k: ir.Value | int) -> ir.Value:
        k = ir.Constant(INT64, k) if isinstance(k, int) else k
        return self.builder.load(self.place(row, k))

    def store(self, row: int, k: ir.Value, value: ir.Value) -> None:
        self.builder.store(value, self.place(row, k))

    def number(self, i: int) -> ir.Value:
        return self.builder.load(self.builder.gep(self.numbers, [ir.Constant(INT64, i)]))

    def real(self, k: ir.Value) -> ir.Value:
        return self.builder.sitofp(k, DOUBLE)

    def fma(self, a: ir.Value, b: ir.Value, c: ir.Value) -> ir.Value:
        return call_llvm(self.builder, "fma", a, b, c)

    def share(self, value: ir.Value, by: int) -> ir.Value:
        """Return `value` / (k + by)."""
        inverse = self.builder.fdiv(_real(1.0), self.real(self.shifted(by)))
        return self.builder.fmul(value, inverse)

    def sum(self, total: ir.Value, rows: tuple[int, ...], first_number: int) -> ir.Value:
        for i, row in enumerate(rows):
            total = self.fma(self.number(first_number + i), self.load(row, self.k), total)
        return total

    def write_sum(self, code: int, out: int, total: ir.Value) -> None:
        if code == ACCELERATE:
            rate = self.share(total, 1)
            self.store(RATES + out, self.shifted(1), rate)
            self.store(out, self.shifted(2), self.share(rate, 2))
        else:
            self.store(out, self.k, total)


def _real(value: float) -> ir.Value:
    return ir.Constant(DOUBLE, value)


class _First(_Order):
    """Instructions for the coefficients of order 0."""

    def __init__(self, builder: ir.IRBuilder, arguments: Sequence[ir.Value]) -> None:
        super().__init__(builder, arguments, ir.Constant(INT64, 0))

    def emit(self, operations: Sequence[_Shape]) -> None:
        at = 0
        for code, out, rows, many in operations:
            if code in SUMS:
                self.write_sum(code, out, self.sum(self.number(at), rows, at + 1))
            elif code in (WAVE, SINE):
                if code == WAVE:
                    angle = self.fma(self.number(at + 1), self.load(TIME, 0), self.number(at))
                else:
                    angle = self.load(rows[0], 0)
                self.store(out, self.k, call_llvm(self.builder, "sin", angle))
                self.store(out + 1, self.k, call_llvm(self.builder, "cos", angle))
            elif code in (ROOT, ROUND):
                function = "sqrt" if code == ROOT else "rint"
                self.store(out, self.k, call_llvm(self.builder, function, self.load(rows[0], 0)))
            elif code == POWER:
                value = call_llvm(self.builder, "pow", self.load(rows[0], 0), self.number(at))
                self.store(out, self.k, value)
            elif code == ENTRY:
                self.store(out, self.k, self.entry(rows[0], at, many))
            else:
                value = self.builder.fmul(self.load(rows[0], 0), self.load(rows[1], 0))
                if code == SIGNED:
                    value = self.builder.fmul(value, self.direction)
                self.store(out, self.k, value)
            at += many

    def entry(self, row: int, first: int, size: int) -> ir.Value:
        """Return the number at the whole number in a row, of `size` numbers that repeat."""
        place = self.builder.fptosi(call_llvm(self.builder, "rint", self.load(row, 0)), INT64)
        length = ir.Constant(INT64, size)
        # The remainder has the sign of the place.
        place = self.builder.srem(place, length)
        place = self.builder.srem(self.builder.add(place, length), length)
        place = self.builder.add(place, ir.Constant(INT64, first))
        return self.builder.load(self.builder.gep(self.numbers, [place]))


class _Further(_Order):
    """Instructions for the coefficients of an order from 1 on."""

    def emit(self, operations: Sequence[_Shape]) -> None:
        pairs = [pair for operation in operations for pair in _convolved(operation)]
        self.middles = self.convolutions(pairs)
        at = 0
        for code, out, rows, many in operations:
            if code in SUMS:
                total = self.sum(_real(0.0), rows, at + 1)
                self.write_sum(code, out, total)
                if code == MOVES:
                    rate = self.builder.fmul(self.real(self.k), total)
                    self.store(out + 1, self.shifted(-1), rate)
            elif code == WAVE:
                speed = self.builder.fmul(self.number(at + 1), self.load(TIME, 1))
                self.turn(out, self.share(speed, 0))
            elif code == SINE:
                self.sine(out, rows[0])
            elif code in (ROUND, ENTRY):
                self.store(out, self.k, _real(0.0))
            elif code == ROOT:
                self.root(out, rows[0])
            elif code == POWER:
                self.power(out, rows[0], self.number(at))
            else:
                self.product(code, out, *rows)
            at += many

    def convolutions(self, pairs: list[tuple[int, int, bool]]) -> dict[Any, ir.Value]:
        """Return the sums of a_j b_(k-j), or j a_j b_(k-j), over 0 < j < k."""
        if not pairs:
            return {}
        builder = self.builder
        before = builder.block
        loop = builder.append_basic_block()
        after = builder.append_basic_block()
        last = self.shifted(-2)
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
        rest = builder.sub(self.k, j)
        totals = []
        for total, a, b, weighted in sums:
            factor = self.load(a, j)
            if weighted:
                factor = builder.fmul(self.real(j), factor)
            totals.append(self.fma(factor, self.load(b, rest), total))
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
        before_last = self.shifted(-1)
        for pair, total in zip(pairs, middles, strict=True):
            a, b, weighted = pair
            first = builder.fmul(masks[0], self.load(a, 1))
            total = self.fma(first, self.load(b, before_last), total)
            second = builder.fmul(masks[1], self.load(b, 1))
            if weighted:
                second = builder.fmul(second, self.real(before_last))
            found[pair] = self.fma(second, self.load(a, before_last), total)
        return found

    def product(self, code: int, out: int, a: int, b: int) -> None:
        total = self.middles[a, b, False]
        if a == b:
            doubled = self.builder.fmul(_real(2.0), self.load(a, 0))
            total = self.fma(doubled, self.load(a, self.k), total)
        else:
            total = self.fma(self.load(b, 0), self.load(a, self.k), total)
            total = self.fma(self.load(a, 0), self.load(b, self.k), total)
        if code == SIGNED:
            total = self.builder.fmul(total, self.direction)
        self.store(out, self.k, total)

    def turn(self, out: int, angle: ir.Value) -> None:
        """Continue sine and cosine of an angle that is linear in time."""
        before = self.shifted(-1)
        self.store(out, self.k, self.builder.fmul(angle, self.load(out + 1, before)))
        back = self.builder.fmul(self.builder.fneg(angle), self.load(out, before))
        self.store(out + 1, self.k, back)

    def sine(self, out: int, angle: int) -> None:
        newest = self.builder.fmul(self.real(self.k), self.load(angle, self.k))
        s = self.fma(newest, self.load(out + 1, 0), self.middles[angle, out + 1, True])
        c = self.fma(newest, self.load(out, 0), self.middles[angle, out, True])
        self.store(out, self.k, self.share(s, 0))
        self.store(out + 1, self.k, self.builder.fneg(self.share(c, 0)))

    def root(self, out: int, square: int) -> None:
        rest = self.builder.fsub(self.load(square, self.k), self.middles[out, out, False])
        doubled = self.builder.fmul(_real(2.0), self.load(out, 0))
        self.store(out, self.k, self.builder.fdiv(rest, doubled))

    def power(self, out: int, base: int, exponent: ir.Value) -> None:
        # k b_0 p_k is the sum of (e (k - j) - j) b_(k-j) p_j over j < k, with the exponent e.
        whole = self.fma(self.load(base, self.k), self.load(out, 0), self.middles[out, base, False])
        scale = self.builder.fmul(exponent, self.real(self.k))
        less = self.builder.fadd(exponent, _real(1.0))
        less = self.builder.fmul(less, self.middles[out, base, True])
        total = self.builder.fsub(self.builder.fmul(scale, whole), less)
        self.store(out, self.k, self.builder.fdiv(self.share(total, 0), self.load(base, 0)))


def _convolved(operation: _Shape) -> list[tuple[int, int, bool]]:
    """Return the pairs of series that an operation convolves, and if one is differentiated."""
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


def _emit(function: ir.Function, first: Sequence[_Shape], second: Sequence[_Shape]) -> None:
    """Write the instructions of a function of `_compiled`."""
    arguments = function.args
    start, stop = arguments[3:]
    builder = ir.IRBuilder(function.append_basic_block())
    entry = builder.block
    zeroth, further, moving, end = (function.append_basic_block() for _ in range(4))
    zero, one = ir.Constant(INT64, 0), ir.Constant(INT64, 1)
    moved = sum(many for *_, many in second)
    numbers = builder.gep(arguments[1], [ir.Constant(INT64, moved)])
    pushing = arguments[0], numbers, arguments[2]
    builder.cbranch(builder.icmp_signed("==", start, zero), zeroth, further)

    builder.position_at_end(zeroth)
    _First(builder, pushing).emit(first)
    after_zeroth = builder.block
    builder.branch(moving)

    builder.position_at_end(further)
    k = builder.phi(INT64)
    k.add_incoming(start, entry)
    _Further(builder, pushing, k).emit(first)
    after_further = builder.block
    builder.branch(moving)

    builder.position_at_end(moving)
    done = builder.phi(INT64)
    done.add_incoming(zero, after_zeroth)
    done.add_incoming(k, after_further)
    if second:
        _Further(builder, arguments, builder.add(done, ir.Constant(INT64, 2))).emit(second)
    following = builder.add(done, one)
    k.add_incoming(following, builder.block)
    builder.cbranch(builder.icmp_signed("<", following, stop), further, end)

    builder.position_at_end(end)
    builder.ret_void()


@cache
def _engine() -> binding.ExecutionEngine:
    """Return what holds all compiled functions, for the life of the process."""
    target = binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=1,
        jit=True,
    )
    return binding.create_mcjit_compiler(binding.parse_assembly(""), target)


_names = (f"gearmesh_recurrence_{i}" for i in count())


@cache
def _compiled(first: tuple[_Shape, ...], second: tuple[_Shape, ...] = ()) -> int:
    """Return the address of a function that carries out operations.

    It takes the table of series, its numbers, the sign of y', and the orders from which and before
    which it works. The operations of `second`, whose numbers precede the others, are two orders
    ahead: the accelerations give the coefficients of the coordinates there.
    """
    module = ir.Module()
    module.triple = binding.get_default_triple()
    name = next(_names)
    _emit(ir.Function(module, _SIGNATURE, name), first, second)
    engine = _engine()
    engine.add_module(binding.parse_assembly(str(module)))
    engine.finalize_object()
    return engine.get_function_address(name)


@intrinsic
def carry_out(typingctx, address, series, numbers, place, direction, start, stop):  # type: ignore[no-untyped-def]
    """Call a function of `Recurrences`, whose numbers begin at `place`."""

    def codegen(context, builder, sig, args):  # type: ignore[no-untyped-def]
        function = builder.inttoptr(args[0], _SIGNATURE.as_pointer())
        numbers = builder.gep(args[2], [args[3]])
        builder.call(function, [args[1], numbers, *args[4:]])
        return context.get_dummy_value()

    signature = types.void(
        types.int64, POINTER, POINTER, types.int64, types.float64, types.int64, types.int64
    )
    return signature, codegen
