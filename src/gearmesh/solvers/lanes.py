"""SIMD lanes for numba: a vector of doubles as one value of a compiled function.

One lane holds one run, and every operation acts on all lanes at once. All of them are the IEEE
operations of a single double (and the fused multiply-add, which is exact before its one
rounding), so a lane's result depends neither on the number of lanes nor on its neighbours:
ensembles equal single runs bit for bit.

Only what the solver needs is here: arithmetic, comparisons, selection, rows of an array, and two
coarse powers of two for step sizes. A compiled function learns the number of lanes from an
argument of lane type (``like``), made by `zeros8` or `zeros1`.
"""

import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import (
    intrinsic,
    lower_builtin,
    models,
    register_model,
    type_callable,
)

_DOUBLE = ir.DoubleType()
_INT64 = ir.IntType(64)
_BIT = ir.IntType(1)


def _vector(element, width):
    """Return the LLVM type of a vector; one of a single lane is a plain number."""
    return element if width == 1 else ir.VectorType(element, width)


class LaneType(types.Type):
    """A vector of `width` doubles."""

    def __init__(self, width):
        self.width = width
        super().__init__(name=f"Lanes({width})")


class MaskType(types.Type):
    """A vector of `width` booleans."""

    def __init__(self, width):
        self.width = width
        super().__init__(name=f"Mask({width})")


@register_model(LaneType)
class _LaneModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, _vector(_DOUBLE, fe_type.width))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, _vector(_BIT, fe_type.width))


def _numbers(values):
    if len(values) == 1:
        return ir.Constant(_DOUBLE, values[0])
    return ir.Constant(ir.VectorType(_DOUBLE, len(values)), list(values))


def _constant(width, value):
    return _numbers([value] * width)


def _spread(builder, width, scalar):
    if width == 1:
        return scalar
    vector = ir.Constant(ir.VectorType(_DOUBLE, width), ir.Undefined)
    for lane in range(width):
        vector = builder.insert_element(vector, scalar, ir.Constant(ir.IntType(32), lane))
    return vector


def _width(value):
    """Return the number of lanes of an LLVM value."""
    return getattr(value.type, "count", 1)


def _binary(operation, result, build):
    """Register `operation` on two lane vectors, or on a lane vector and a scalar."""

    @type_callable(operation)
    def _typer(context):
        def typer(a, b):
            vector = a if isinstance(a, LaneType) else b
            if not isinstance(vector, LaneType):
                return None
            scalar = (types.Float, types.Integer)
            if all(x == vector or isinstance(x, scalar) for x in (a, b)):
                return result(vector.width)
            return None

        return typer

    def lower(context, builder, sig, args):
        width = next(t.width for t in sig.args if isinstance(t, LaneType))
        operands = []
        for kind, value in zip(sig.args, args, strict=True):
            if not isinstance(kind, LaneType):
                value = context.cast(builder, value, kind, types.float64)
                value = _spread(builder, width, value)
            operands.append(value)
        return build(builder, *operands)

    for left, right in (
        (LaneType, LaneType),
        (LaneType, types.Number),
        (types.Number, LaneType),
    ):
        lower_builtin(operation, left, right)(lower)


_binary(operator.add, LaneType, lambda b, x, y: b.fadd(x, y))
_binary(operator.sub, LaneType, lambda b, x, y: b.fsub(x, y))
_binary(operator.mul, LaneType, lambda b, x, y: b.fmul(x, y))
_binary(operator.truediv, LaneType, lambda b, x, y: b.fdiv(x, y))
_binary(operator.lt, MaskType, lambda b, x, y: b.fcmp_ordered("<", x, y))
_binary(operator.le, MaskType, lambda b, x, y: b.fcmp_ordered("<=", x, y))
_binary(operator.gt, MaskType, lambda b, x, y: b.fcmp_ordered(">", x, y))
_binary(operator.ge, MaskType, lambda b, x, y: b.fcmp_ordered(">=", x, y))
_binary(operator.eq, MaskType, lambda b, x, y: b.fcmp_ordered("==", x, y))


def _masks(operation, build):
    @type_callable(operation)
    def _typer(context):
        def typer(a, b):
            return a if isinstance(a, MaskType) and a == b else None

        return typer

    @lower_builtin(operation, MaskType, MaskType)
    def _lower(context, builder, sig, args):
        return build(builder, *args)


_masks(operator.and_, lambda b, x, y: b.and_(x, y))
_masks(operator.or_, lambda b, x, y: b.or_(x, y))


@type_callable(operator.neg)
def _type_neg(context):
    return lambda a: a if isinstance(a, LaneType) else None


@lower_builtin(operator.neg, LaneType)
def _lower_neg(context, builder, sig, args):
    return builder.fneg(args[0])


@type_callable(operator.invert)
def _type_invert(context):
    return lambda a: a if isinstance(a, MaskType) else None


@lower_builtin(operator.invert, MaskType)
def _lower_invert(context, builder, sig, args):
    return builder.not_(args[0])


def _zeros(width):
    @intrinsic
    def zeros(typingctx):
        def codegen(context, builder, sig, args):
            return _constant(width, 0.0)

        return LaneType(width)(), codegen

    return zeros


zeros1 = _zeros(1)
zeros8 = _zeros(8)

WIDEST = 8
"""Most lanes that a vector has."""


@intrinsic
def width_of(typingctx, like):
    """Return the number of lanes of `like`."""

    def codegen(context, builder, sig, args):
        return context.get_constant(types.int64, like.width)

    return types.int64(like), codegen


@intrinsic
def spread(typingctx, like, scalar):
    """Return `scalar` in every lane."""

    def codegen(context, builder, sig, args):
        value = context.cast(builder, args[1], sig.args[1], types.float64)
        return _spread(builder, like.width, value)

    return like(like, scalar), codegen


_POINTER = types.CPointer(types.float64)


@intrinsic
def pointer_to(typingctx, array):
    """Return where a float64 array begins.

    Functions that pass a workspace on by its pointer count no references, which takes as long as
    dozens of operations; the caller has to keep the array.
    """

    def codegen(context, builder, sig, args):
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return _POINTER(array), codegen


def _row_pointer(builder, data, row, width):
    offset = builder.mul(row, ir.Constant(row.type, width))
    return builder.bitcast(builder.gep(data, [offset]), _vector(_DOUBLE, width).as_pointer())


@intrinsic
def load(typingctx, like, work, row):
    """Return row `row` of a workspace whose rows have one element for each lane."""

    def codegen(context, builder, sig, args):
        row = context.cast(builder, args[2], sig.args[2], types.intp)
        return builder.load(_row_pointer(builder, args[1], row, like.width), align=8)

    return like(like, _POINTER, row), codegen


@intrinsic
def store(typingctx, work, row, value):
    """Write `value` to row `row` of a workspace."""

    def codegen(context, builder, sig, args):
        row = context.cast(builder, args[1], sig.args[1], types.intp)
        builder.store(args[2], _row_pointer(builder, args[0], row, value.width), align=8)
        return context.get_dummy_value()

    return types.void(_POINTER, row, value), codegen


@intrinsic
def store_at(typingctx, array, index, value):
    """Write the lanes of `value` to consecutive elements of a flat array, from `index` on."""

    def codegen(context, builder, sig, args):
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        index = context.cast(builder, args[1], sig.args[1], types.intp)
        kind = _vector(_DOUBLE, value.width).as_pointer()
        builder.store(args[2], builder.bitcast(builder.gep(data, [index]), kind), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


def _call(builder, name, *args):
    kind, width = args[0].type, _width(args[0])
    suffix = "f64" if width == 1 else f"v{width}f64"
    function_type = ir.FunctionType(kind, [kind] * len(args))
    name = f"llvm.{name}.{suffix}"
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    return builder.call(function, args)


@intrinsic
def fma(typingctx, a, b, c):
    """Return a b + c with one rounding."""

    def codegen(context, builder, sig, args):
        return _call(builder, "fma", *args)

    return a(a, b, c), codegen


@intrinsic
def magnitude(typingctx, a):
    """Return |a|."""

    def codegen(context, builder, sig, args):
        return _call(builder, "fabs", *args)

    return a(a), codegen


@intrinsic
def select(typingctx, mask, a, b):
    """Return `a` where `mask` is set, else `b`."""

    def codegen(context, builder, sig, args):
        return builder.select(*args)

    return a(mask, a, b), codegen


def _bits(builder, mask):
    """Return the lanes of a mask as the bits of an integer."""
    width = _width(mask)
    return mask if width == 1 else builder.bitcast(mask, ir.IntType(width))


@intrinsic
def any_lane(typingctx, mask):
    """Return whether `mask` is set in some lane."""

    def codegen(context, builder, sig, args):
        bits = _bits(builder, args[0])
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), codegen


@intrinsic
def lane_bits(typingctx, mask):
    """Return `mask` as an integer, lane 0 in its lowest bit."""

    def codegen(context, builder, sig, args):
        return builder.zext(_bits(builder, args[0]), _INT64)

    return types.int64(mask), codegen


@intrinsic
def lowest_bit(typingctx, bits):
    """Return the place of the lowest bit set in `bits`, which is not 0."""

    def codegen(context, builder, sig, args):
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), codegen


@intrinsic
def lane_numbers(typingctx, like):
    """Return 0, 1, 2, ... in the lanes."""

    def codegen(context, builder, sig, args):
        return _numbers([float(lane) for lane in range(like.width)])

    return like(like), codegen


class _Traced:
    """A lane vector while a function is being unrolled: its operators emit instructions."""

    def __init__(self, builder, value):
        self.builder = builder
        self.value = value

    def _operand(self, other):
        if isinstance(other, _Traced):
            return other.value
        return _constant(_width(self.value), float(other))

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
        return _Traced(self.builder, _call(self.builder, "fma", *operands))

    def times_each(self, factors):
        """Return self times each of the factors, side by side in one longer vector."""
        width = _width(self.value)
        constant = _numbers([factor for factor in factors for _ in range(width)])
        repeated = self.repeated(len(factors)).value
        return _Traced(self.builder, self.builder.fmul(repeated, constant))

    def repeated(self, times):
        """Return self several times, side by side in one longer vector."""
        width = _width(self.value)
        if width == 1:
            return _Traced(self.builder, _spread(self.builder, times, self.value))
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
        offset = ir.Constant(_INT64, row * self.width)
        return self.builder.bitcast(self.builder.gep(self.data, [offset]), kind.as_pointer())

    def __getitem__(self, row):
        pointer = self._pointer(row, _vector(_DOUBLE, self.width))
        return _Traced(self.builder, self.builder.load(pointer, align=8))

    def __setitem__(self, row, traced):
        self.builder.store(traced.value, self._pointer(row, traced.value.type), align=8)


def unrolled(function):
    """Compile `function(rows)` to straight-line code, called as ``compiled(like, work)``.

    `function` runs once, at compile time; its loops and lists vanish, and what remains are the
    operations on the rows of the workspace that it reads and writes. A recurrence whose loops are
    short and depend on each other is several times faster so.
    """

    @intrinsic
    def compiled(typingctx, like, work):
        def codegen(context, builder, sig, args):
            function(_Rows(builder, args[1], like.width))
            return context.get_dummy_value()

        return types.void(like, _POINTER), codegen

    return compiled


COARSENESS = 0.0861
"""Most by which `coarse_log2` is too small, and `coarse_exp2` too large in its exponent."""


@intrinsic
def coarse_log2(typingctx, a):
    """Return log2 of the positive `a` (exponent plus mantissa), at most `COARSENESS` too small."""

    def codegen(context, builder, sig, args):
        width = a.width
        bits = builder.bitcast(args[0], _vector(_INT64, width))
        value = builder.sitofp(bits, _vector(_DOUBLE, width))
        value = builder.fmul(value, _constant(width, 2.0**-52))
        return builder.fsub(value, _constant(width, 1023.0))

    return a(a), codegen


@intrinsic
def coarse_exp2(typingctx, a):
    """Return 2^a for |a| < 1022, too large by at most 6.2 %."""

    def codegen(context, builder, sig, args):
        width = a.width
        value = builder.fadd(args[0], _constant(width, 1023.0))
        value = builder.fmul(value, _constant(width, 2.0**52))
        bits = builder.fptosi(value, _vector(_INT64, width))
        return builder.bitcast(bits, _vector(_DOUBLE, width))

    return a(a), codegen
