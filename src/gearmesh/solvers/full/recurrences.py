"""The operations of a tape as machine code.

Every branch of the laws becomes four functions that fill the table of series, order by order. The
numbers are data, so branches whose operations differ only in their numbers share the functions.
`coefficients` writes the instructions of a function. LLVM compiles them in a few milliseconds, when
a run in this process first needs the function.
"""

import ctypes
from collections.abc import Iterable
from dataclasses import replace
from functools import cache, lru_cache
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.extending import intrinsic

from gearmesh.model.motion import ROTATION_2, ROTATION_3
from gearmesh.model.problem import Problem
from gearmesh.solvers.full.coefficients import First, Further, Shape
from gearmesh.solvers.full.coordinates import embedding, projected
from gearmesh.solvers.full.tape import (
    ACCELERATE,
    COORDINATES,
    ENTRY,
    FIRST_FREE,
    POWER,
    SUMS,
    WAVE,
    Operation,
    laws_of,
    record,
)
from gearmesh.solvers.lanes.rows import POINTER
from gearmesh.solvers.lanes.types import DOUBLE, INT64

_POINTER = DOUBLE.as_pointer()
_ARGUMENTS = [_POINTER, _POINTER, DOUBLE, INT64, INT64]
_SIGNATURE = ir.FunctionType(ir.VoidType(), _ARGUMENTS)


MOTION, FORCES, NORMAL_FORCE, SAMPLED = range(4)
"""Functions of a branch: y, the accelerations, the normal force, the other sampled quantities."""

N_PARTS = 4


class Recurrences(NamedTuple):
    """Recurrences of all branches of the laws, in the form that the compiled solver takes.

    Attributes
    ----------
    numbers : ndarray
        Numbers of the operations.
    branches : ndarray of int, shape (`N_BRANCHES` * segments, 8)
        Addresses of the four functions of a branch, then the places in `numbers` where their
        numbers begin. A branch that cannot occur has zeros.
    height : int
        Number of rows that the table of series needs.
    constants : ndarray of int, shape (n, 2)
        Places in `numbers` of the constants of accelerations, and their coordinates.
    """

    numbers: np.ndarray
    branches: np.ndarray
    height: int
    constants: np.ndarray


def recurrences(problem: Problem, segments: Iterable[float], sampled: bool) -> Recurrences:
    """Return the recurrences of a problem.

    Parameters
    ----------
    problem : Problem
    segments : iterable of float
        A mesh phase in each segment.
    sampled : bool
        As for `gearmesh.solvers.full.coordinates.embedding`.
    """
    terms = problem.terms
    both = terms.torque_harmonics_3, terms.torque_harmonics_2
    constant = [sum(one.cosine for one in several if one.order == 0.0) for several in both]
    if not any(constant):
        return _recurrences(laws_of(problem), tuple(segments), sampled)
    # Constant moments add to constants. Runs that differ in them share what is recorded and
    # compiled: a drive that holds the speed changes them all the time.
    varying = [tuple(one for one in several if one.order != 0.0) for several in both]
    terms = replace(terms, torque_harmonics_3=varying[0], torque_harmonics_2=varying[1])
    bare = replace(problem, terms=terms)
    found = _recurrences(laws_of(bare), tuple(segments), sampled)
    accelerations = np.zeros(12)
    for i, moment, wheel in zip(
        (ROTATION_3, ROTATION_2), constant, problem.both_wheels, strict=True
    ):
        accelerations[i] = moment / wheel.inertia
    numbers, (places, coordinates) = found.numbers.copy(), found.constants.T
    numbers[places] += projected(accelerations, embedding(bare, sampled))[coordinates]
    return found._replace(numbers=numbers)


@lru_cache(maxsize=256)
def _recurrences(laws: Problem, segments: tuple[float, ...], sampled: bool) -> Recurrences:
    numbers: list[float] = []
    branches, wanted = [], []
    height = FIRST_FREE
    constants = []
    for parts in record(laws, segments, sampled):
        if not parts:
            branches.append([0] * (2 * N_PARTS))
            wanted.append(())
            continue
        places = []
        for part in parts:
            places.append(len(numbers))
            for operation in part:
                if operation[0] == ACCELERATE:
                    constants.append((len(numbers), operation[1] - COORDINATES))
                numbers += _numbers(operation)
            height = max([height, *(out + 2 for _, out, _ in part)])
        places[FORCES] = places[MOTION]  # this function carries out the operations of y too
        moves, *others = (tuple(_shape(operation) for operation in part) for part in parts)
        forces, presses, sample = others
        wanted.append(((moves, ()), (forces, moves), (presses, ()), (sample, ())))
        branches.append([0] * N_PARTS + places)
    found = Recurrences(
        np.array(numbers), np.array(branches, np.int64), height, np.array(constants)
    )
    for branch, functions in zip(found.branches, wanted, strict=True):
        for part, function in enumerate(functions):
            branch[part] = _compiled.get(function) or _compiles_itself(branch, part, function)
    return found


def _shape(operation: Operation) -> Shape:
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
    """Return the numbers of an operation; a sum or an angle has its constant first."""
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


def _emit(function: ir.Function, first: tuple[Shape, ...], second: tuple[Shape, ...]) -> None:
    """Write the instructions of a function; see `_compile`."""
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
    First(builder, pushing).emit(first)
    after_zeroth = builder.block
    builder.branch(moving)

    builder.position_at_end(further)
    k = builder.phi(INT64)
    k.add_incoming(start, entry)
    Further(builder, pushing, k).emit(first)
    after_further = builder.block
    builder.branch(moving)

    builder.position_at_end(moving)
    done = builder.phi(INT64)
    done.add_incoming(zero, after_zeroth)
    done.add_incoming(k, after_further)
    if second:
        # As a call, not in line: many functions share it, and this halves what LLVM compiles.
        address = ir.Constant(INT64, _compile((second, ())))
        order = builder.add(done, ir.Constant(INT64, 2))
        moves = builder.inttoptr(address, _SIGNATURE.as_pointer())
        builder.call(moves, [*arguments[:3], order, builder.add(order, one)])
    following = builder.add(done, one)
    k.add_incoming(following, builder.block)
    builder.cbranch(builder.icmp_signed("<", following, stop), further, end)

    builder.position_at_end(end)
    builder.ret_void()


@cache
def _engine() -> binding.ExecutionEngine:
    """Return the engine that holds all compiled functions for the life of the process."""
    target = binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=1,
        jit=True,
    )
    return binding.create_mcjit_compiler(binding.parse_assembly(""), target)


_names = (f"gearmesh_recurrence_{i}" for i in count())


_Function = tuple[tuple[Shape, ...], tuple[Shape, ...]]
"""Operations that a function carries out, and those that it carries out two orders ahead."""

_compiled: dict[_Function, int] = {}
"""Addresses of the functions that have been compiled, for the life of the process."""

_CALL = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_int64, ctypes.c_int64
)
_waiting: list[Any] = []  # ctypes does not keep its functions alive
_failures: list[BaseException] = []


def _compiles_itself(branch: np.ndarray, part: int, function: _Function) -> int:
    """Return the address of a function that replaces itself by compiled code when first called.

    A problem has many branches and a run reaches few of them, so few functions are compiled. An
    exception cannot pass through the compiled code that calls this function, so it is stored, and
    `raise_failures` raises it later.
    """

    def call(*arguments: Any) -> None:
        try:
            branch[part] = _compile(function)
            _CALL(int(branch[part]))(*arguments)
        except BaseException as error:
            _failures.append(error)

    _waiting.append(_CALL(call))
    return ctypes.cast(_waiting[-1], ctypes.c_void_p).value or 0


def raise_failures() -> None:
    """Raise the exception, such as an interruption, that `_compiles_itself` has stored."""
    if _failures:
        error = _failures[0]
        _failures.clear()
        raise error


def _compile(function: _Function) -> int:
    """Return the address of a function, which is compiled once in a process.

    Its arguments are the table of series, its numbers, the sign of y', the first order, and the
    order before which it stops. The operations that run two orders ahead are those of y, since the
    accelerations of order k give the coordinates of order k + 2. Their numbers come first.
    """
    if function in _compiled:
        return _compiled[function]
    module = ir.Module()
    module.triple = binding.get_default_triple()
    name = next(_names)
    _emit(ir.Function(module, _SIGNATURE, name), *function)
    engine = _engine()
    engine.add_module(binding.parse_assembly(str(module)))
    engine.finalize_object()
    _compiled[function] = engine.get_function_address(name)
    return _compiled[function]


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
