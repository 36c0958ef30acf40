"""Recurrences unrolled to straight-line code."""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from gearmesh.solvers.lanes.rows import POINTER
from gearmesh.solvers.lanes.types import (
    DOUBLE,
    INT64,
    call_llvm,
    constant,
    numbers,
    repeat,
    vector_type,
    width_of_value,
)


class _Traced:
    """A lane vector while a function is being unrolled: its operators emit instructions."""

    def __init__(self, builder, value):
        self.builder = builder
        self.value = value

    def _operand(self, other):
        if isinstance(other, _Traced):
            return other.value
        return constant(width_of_value(self.value), float(other))

    def __add__(self, other):
        return _Traced(self.builder, self.builder.fadd(self.value, self._operand(other)))

    def __sub__(self, other):
        return _Traced(self.builder, self.builder.fsub(self.value, self._operand(other)))

    def __mul__(self, other):
        return _Traced(self.builder, self.builder.fmul(self.value, self._operand(other)))

    def __neg__(self):
        return _Traced(self.builder, self.builder.fneg(self.value))

    def times_plus(self, factor, summand):
        """Return self factor + summand with one rounding."""
        operands = (self.value, self._operand(factor), self._operand(summand))
        return _Traced(self.builder, call_llvm(self.builder, "fma", *operands))

    def magnitude(self):
        """Return the absolute value."""
        return _Traced(self.builder, call_llvm(self.builder, "fabs", self.value))

    def first(self):
        """Return the first lane in every lane."""
        width = width_of_value(self.value)
        mask = ir.Constant(ir.VectorType(ir.IntType(32), width), [0] * width)
        return _Traced(self.builder, self.builder.shuffle_vector(self.value, self.value, mask))

    def times_each(self, factors):
        """Return self times each of the factors, side by side in one longer vector."""
        width = width_of_value(self.value)
        constant = numbers([factor for factor in factors for _ in range(width)])
        repeated = self.repeated(len(factors)).value
        return _Traced(self.builder, self.builder.fmul(repeated, constant))

    def repeated(self, times):
        """Return self several times, side by side in one longer vector."""
        width = width_of_value(self.value)
        if width == 1:
            return _Traced(self.builder, repeat(self.builder, times, self.value))
        places = [i % width for i in range(times * width)]
        mask = ir.Constant(ir.VectorType(ir.IntType(32), len(places)), places)
        return _Traced(self.builder, self.builder.shuffle_vector(self.value, self.value, mask))


class _Rows:
    """The rows of a workspace while a function is being unrolled.

    A longer vector that is written to a row fills the rows after it too.
    """

    def __init__(self, builder, data, width):
        self.builder = builder
        self.data = data
        self.width = width

    def _pointer(self, row, kind):
        offset = ir.Constant(INT64, row * self.width)
        return self.builder.bitcast(self.builder.gep(self.data, [offset]), kind.as_pointer())

    def __getitem__(self, row):
        pointer = self._pointer(row, vector_type(DOUBLE, self.width))
        return _Traced(self.builder, self.builder.load(pointer, align=8))

    def __setitem__(self, row, traced):
        self.builder.store(traced.value, self._pointer(row, traced.value.type), align=8)

    def several(self, row, count):
        """Return `count` rows from `row` on, side by side in one longer vector."""
        pointer = self._pointer(row, vector_type(DOUBLE, count * self.width))
        return _Traced(self.builder, self.builder.load(pointer, align=8))

    def first(self, row):
        """Return the first lane of a row in every lane."""
        value = self.builder.load(self._pointer(row, DOUBLE), align=8)
        return _Traced(self.builder, repeat(self.builder, self.width, value))

    def settle(self):
        """Keep what has been written in memory only, from where later instructions read it.

        A processor has too few registers for all rows, and LLVM would write them twice.
        """
        barrier = ir.FunctionType(ir.VoidType(), [])
        self.builder.asm(barrier, "", "~{memory}", [], side_effect=True)


def unrolled(function):
    """Compile `function(rows)` to straight-line code, called as ``compiled(like, work)``.

    `function` runs once, at compile time; its loops and lists vanish, and what remains are the
    operations on the rows of the workspace that it reads and writes. This makes a recurrence with
    short loops that depend on each other several times faster.
    """

    @intrinsic
    def compiled(typingctx, like, work):
        def codegen(context, builder, sig, args):
            function(_Rows(builder, args[1], like.width))
            return context.get_dummy_value()

        return types.void(like, POINTER), codegen

    return compiled
