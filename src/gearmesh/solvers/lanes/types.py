"""The types of lanes and masks, their LLVM values, and their operators."""

import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import lower_builtin, models, register_model, type_callable

DOUBLE = ir.DoubleType()
INT64 = ir.IntType(64)
BIT = ir.IntType(1)


def vector_type(element, width):
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
        super().__init__(dmm, fe_type, vector_type(DOUBLE, fe_type.width))


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, vector_type(BIT, fe_type.width))


def numbers(values):
    """Return constant doubles, one for each lane."""
    if len(values) == 1:
        return ir.Constant(DOUBLE, values[0])
    return ir.Constant(ir.VectorType(DOUBLE, len(values)), list(values))


def constant(width, value):
    """Return the same constant double in every lane."""
    return numbers([value] * width)


def repeat(builder, width, scalar):
    """Return an LLVM double in every lane."""
    if width == 1:
        return scalar
    vector = ir.Constant(ir.VectorType(DOUBLE, width), ir.Undefined)
    for lane in range(width):
        vector = builder.insert_element(vector, scalar, ir.Constant(ir.IntType(32), lane))
    return vector


def width_of_value(value):
    """Return the number of lanes of an LLVM value."""
    return getattr(value.type, "count", 1)


def call_llvm(builder, name, *args):
    """Call an intrinsic function of LLVM that acts lane by lane, such as ``fma``."""
    kind, width = args[0].type, width_of_value(args[0])
    suffix = "f64" if width == 1 else f"v{width}f64"
    function_type = ir.FunctionType(kind, [kind] * len(args))
    name = f"llvm.{name}.{suffix}"
    function = cgutils.get_or_insert_function(builder.module, function_type, name)
    return builder.call(function, args)


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
                value = repeat(builder, width, value)
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
