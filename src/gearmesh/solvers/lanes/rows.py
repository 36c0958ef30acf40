"""Rows of a workspace, with one element for each lane."""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from gearmesh.solvers.lanes.types import DOUBLE, vector_type

POINTER = types.CPointer(types.float64)


@intrinsic
def pointer_to(typingctx, array):
    """Return where a float64 array begins.

    A function that takes a workspace as a pointer counts no references, which would take as long as
    dozens of operations. The caller has to keep the array alive.
    """

    def codegen(context, builder, sig, args):
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return POINTER(array), codegen


@intrinsic
def unowned(typingctx, array):
    """Return the same array for code that counts no references to it; the caller keeps it alive."""

    def codegen(context, builder, sig, args):
        view = context.make_array(sig.args[0])(context, builder, args[0])
        view.meminfo = context.get_constant_null(types.MemInfoPointer(types.voidptr))
        return view._getvalue()

    return array(array), codegen


def _row_pointer(builder, data, row, width):
    offset = builder.mul(row, ir.Constant(row.type, width))
    return builder.bitcast(builder.gep(data, [offset]), vector_type(DOUBLE, width).as_pointer())


@intrinsic
def load(typingctx, like, work, row):
    """Return row `row` of a workspace whose rows have one element for each lane."""

    def codegen(context, builder, sig, args):
        row = context.cast(builder, args[2], sig.args[2], types.intp)
        return builder.load(_row_pointer(builder, args[1], row, like.width), align=8)

    return like(like, POINTER, row), codegen


@intrinsic
def store(typingctx, work, row, value):
    """Write `value` to row `row` of a workspace."""

    def codegen(context, builder, sig, args):
        row = context.cast(builder, args[1], sig.args[1], types.intp)
        builder.store(args[2], _row_pointer(builder, args[0], row, value.width), align=8)
        return context.get_dummy_value()

    return types.void(POINTER, row, value), codegen


def _element_pointer(context, builder, sig, args):
    data, *numbers = args[:4]
    width, row, lane = (
        context.cast(builder, number, kind, types.intp)
        for number, kind in zip(numbers, sig.args[1:4], strict=True)
    )
    return builder.gep(data, [builder.add(builder.mul(row, width), lane)])


@intrinsic
def get(typingctx, work, width, row, lane):
    """Return one lane of a row; as compiled functions `get` and `put` would take a second more."""

    def codegen(context, builder, sig, args):
        return builder.load(_element_pointer(context, builder, sig, args))

    return types.float64(POINTER, width, row, lane), codegen


@intrinsic
def put(typingctx, work, width, row, lane, value):
    """Write one lane of a row."""

    def codegen(context, builder, sig, args):
        value = context.cast(builder, args[4], sig.args[4], types.float64)
        builder.store(value, _element_pointer(context, builder, sig, args))
        return context.get_dummy_value()

    return types.void(POINTER, width, row, lane, value), codegen


@intrinsic
def store_at(typingctx, array, index, value):
    """Write the lanes of `value` to consecutive elements of a flat array, from `index` on."""

    def codegen(context, builder, sig, args):
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        index = context.cast(builder, args[1], sig.args[1], types.intp)
        kind = vector_type(DOUBLE, value.width).as_pointer()
        builder.store(args[2], builder.bitcast(builder.gep(data, [index]), kind), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen
