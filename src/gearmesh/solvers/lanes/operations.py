"""Functions of lanes: constants, selection, bits of masks, and coarse powers of two."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from gearmesh.solvers.lanes.types import (
    DOUBLE,
    INT64,
    LaneType,
    call_llvm,
    constant,
    numbers,
    repeat,
    vector_type,
    width_of_value,
)


def _zeros(width):
    @intrinsic
    def zeros(typingctx):
        def codegen(context, builder, sig, args):
            return constant(width, 0.0)

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
        return repeat(builder, like.width, value)

    return like(like, scalar), codegen


@intrinsic
def fma(typingctx, a, b, c):
    """Return a b + c with one rounding."""

    def codegen(context, builder, sig, args):
        return call_llvm(builder, "fma", *args)

    return a(a, b, c), codegen


@intrinsic
def magnitude(typingctx, a):
    """Return |a|."""

    def codegen(context, builder, sig, args):
        return call_llvm(builder, "fabs", *args)

    return a(a), codegen


@intrinsic
def select(typingctx, mask, a, b):
    """Return `a` where `mask` is set, else `b`."""

    def codegen(context, builder, sig, args):
        return builder.select(*args)

    return a(mask, a, b), codegen


def _bits(builder, mask):
    """Return the lanes of a mask as the bits of an integer."""
    width = width_of_value(mask)
    return mask if width == 1 else builder.bitcast(mask, ir.IntType(width))


@intrinsic
def any_lane(typingctx, mask):
    """Return whether `mask` is set in some lane."""

    def codegen(context, builder, sig, args):
        bits = _bits(builder, args[0])
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), codegen


@intrinsic
def least_lane(typingctx, a):
    """Return the least of the lanes, all of which are numbers."""

    def codegen(context, builder, sig, args):
        (vector,) = args
        if a.width == 1:
            return vector
        kind = ir.FunctionType(DOUBLE, [vector.type])
        name = f"llvm.vector.reduce.fmin.v{a.width}f64"
        function = cgutils.get_or_insert_function(builder.module, kind, name)
        return builder.call(function, args, fastmath=("nnan",))

    return types.float64(a), codegen


@intrinsic
def lane_bits(typingctx, mask):
    """Return `mask` as an integer, lane 0 in its lowest bit."""

    def codegen(context, builder, sig, args):
        return builder.zext(_bits(builder, args[0]), INT64)

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
        return numbers([float(lane) for lane in range(like.width)])

    return like(like), codegen


COARSENESS = 0.0861
"""Most by which `coarse_log2` is too small, and `coarse_exp2` too large in its exponent."""


@intrinsic
def coarse_log2(typingctx, a):
    """Return log2 of the positive `a` (exponent plus mantissa), at most `COARSENESS` too small."""

    def codegen(context, builder, sig, args):
        width = a.width
        bits = builder.bitcast(args[0], vector_type(INT64, width))
        value = builder.sitofp(bits, vector_type(DOUBLE, width))
        value = builder.fmul(value, constant(width, 2.0**-52))
        return builder.fsub(value, constant(width, 1023.0))

    return a(a), codegen


@intrinsic
def coarse_exp2(typingctx, a):
    """Return 2^a for |a| < 1022, too large by at most 6.2 %."""

    def codegen(context, builder, sig, args):
        width = a.width
        value = builder.fadd(args[0], constant(width, 1023.0))
        value = builder.fmul(value, constant(width, 2.0**52))
        bits = builder.fptosi(value, vector_type(INT64, width))
        return builder.bitcast(bits, vector_type(DOUBLE, width))

    return a(a), codegen
