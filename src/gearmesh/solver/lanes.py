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
        super().__init__(dmm, fe_type, ir.VectorType(_DOUBLE, fe_type.width))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, ir.VectorType(ir.IntType(1), fe_type.width))


def _constant(width, value):
    return ir.Constant(ir.VectorType(_DOUBLE, width), [value] * width)


def _spread(builder, width, scalar):
    vector = ir.Constant(ir.VectorType(_DOUBLE, width), ir.Undefined)
    for lane in range(width):
        vector = builder.insert_element(vector, scalar, ir.Constant(ir.IntType(32), lane))
    return vector


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


def _element_pointer(context, builder, array_type, array, index_type, index, width, stride):
    data = context.make_array(array_type)(context, builder, array).data
    offset = context.cast(builder, index, index_type, types.intp)
    offset = builder.mul(offset, ir.Constant(offset.type, stride))
    return builder.bitcast(builder.gep(data, [offset]), ir.VectorType(_DOUBLE, width).as_pointer())


@intrinsic
def load(typingctx, like, array, row):
    """Return row `row` of a flat float64 array whose rows have one element for each lane."""

    def codegen(context, builder, sig, args):
        pointer = _element_pointer(
            context, builder, sig.args[1], args[1], sig.args[2], args[2], like.width, like.width
        )
        return builder.load(pointer, align=8)

    return like(like, array, row), codegen


def _storing(stride_of):
    def codegen(context, builder, sig, args):
        width = sig.args[2].width
        pointer = _element_pointer(
            context, builder, sig.args[0], args[0], sig.args[1], args[1], width, stride_of(width)
        )
        builder.store(args[2], pointer, align=8)
        return context.get_dummy_value()

    return codegen


@intrinsic
def store(typingctx, array, row, value):
    """Write `value` to row `row` of a flat float64 array."""
    return types.void(array, row, value), _storing(lambda width: width)


@intrinsic
def store_at(typingctx, array, index, value):
    """Write the lanes of `value` to consecutive elements of a flat array, from `index` on."""
    return types.void(array, index, value), _storing(lambda width: 1)


def _call(builder, name, vector_type, *args):
    suffix = f"v{vector_type.count}f64"
    kind = ir.FunctionType(vector_type, [vector_type] * len(args))
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.{suffix}")
    return builder.call(function, args)


@intrinsic
def fma(typingctx, a, b, c):
    """Return a b + c with one rounding."""

    def codegen(context, builder, sig, args):
        return _call(builder, "fma", args[0].type, *args)

    return a(a, b, c), codegen


@intrinsic
def magnitude(typingctx, a):
    """Return |a|."""

    def codegen(context, builder, sig, args):
        return _call(builder, "fabs", args[0].type, *args)

    return a(a), codegen


@intrinsic
def select(typingctx, mask, a, b):
    """Return `a` where `mask` is set, else `b`."""

    def codegen(context, builder, sig, args):
        return builder.select(*args)

    return a(mask, a, b), codegen


@intrinsic
def any_lane(typingctx, mask):
    """Return whether `mask` is set in some lane."""

    def codegen(context, builder, sig, args):
        bits = builder.bitcast(args[0], ir.IntType(mask.width))
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), codegen


@intrinsic
def lane_bits(typingctx, mask):
    """Return `mask` as an integer, lane 0 in its lowest bit."""

    def codegen(context, builder, sig, args):
        bits = builder.bitcast(args[0], ir.IntType(mask.width))
        return builder.zext(bits, _INT64)

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
        kind = ir.VectorType(_DOUBLE, like.width)
        return ir.Constant(kind, [float(lane) for lane in range(like.width)])

    return like(like), codegen


class _Traced:
    """A lane vector while a function is being unrolled: its operators emit instructions."""

    def __init__(self, builder, value):
        self.builder = builder
        self.value = value

    def _operand(self, other):
        if isinstance(other, _Traced):
            return other.value
        return _constant(self.value.type.count, float(other))

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
        return _Traced(self.builder, _call(self.builder, "fma", self.value.type, *operands))


class _Rows:
    """The rows of a workspace while a function is being unrolled."""

    def __init__(self, builder, data, width):
        self.builder = builder
        self.data = data
        self.kind = ir.VectorType(_DOUBLE, width)

    def _pointer(self, row):
        offset = ir.Constant(_INT64, row * self.kind.count)
        return self.builder.bitcast(self.builder.gep(self.data, [offset]), self.kind.as_pointer())

    def __getitem__(self, row):
        return _Traced(self.builder, self.builder.load(self._pointer(row), align=8))

    def __setitem__(self, row, traced):
        self.builder.store(traced.value, self._pointer(row), align=8)


def unrolled(function):
    """Compile `function(rows)` to straight-line code, called as ``compiled(like, work)``.

    `function` runs once, at compile time; its loops and lists vanish, and what remains are the
    operations on the rows of the workspace that it reads and writes. A recurrence whose loops are
    short and depend on each other is several times faster so.
    """

    @intrinsic
    def compiled(typingctx, like, work):
        def codegen(context, builder, sig, args):
            data = context.make_array(sig.args[1])(context, builder, args[1]).data
            function(_Rows(builder, data, sig.args[0].width))
            return context.get_dummy_value()

        return types.void(like, work), codegen

    return compiled


COARSENESS = 0.0861
"""Most by which `coarse_log2` is too small, and `coarse_exp2` too large in its exponent."""


@intrinsic
def coarse_log2(typingctx, a):
    """Return log2 of the positive `a` (exponent plus mantissa), at most `COARSENESS` too small."""

    def codegen(context, builder, sig, args):
        width = a.width
        bits = builder.bitcast(args[0], ir.VectorType(_INT64, width))
        value = builder.sitofp(bits, ir.VectorType(_DOUBLE, width))
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
        bits = builder.fptosi(value, ir.VectorType(_INT64, width))
        return builder.bitcast(bits, ir.VectorType(_DOUBLE, width))

    return a(a), codegen
