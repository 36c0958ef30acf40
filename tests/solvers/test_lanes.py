"""SIMD lanes: every operation is that of a single double, in every lane."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from gearmesh.solvers.lanes import operations, rows

NUMBERS = st.floats(-1e100, 1e100, allow_nan=False)
EIGHT = st.lists(NUMBERS, min_size=8, max_size=8).map(np.array)


@njit
def _arithmetic(like, a, b, out):
    a, b, out = rows.pointer_to(a), rows.pointer_to(b), rows.pointer_to(out)
    x = rows.load(like, a, 0)
    y = rows.load(like, b, 0)
    rows.store(out, 0, x + y)
    rows.store(out, 1, x - y)
    rows.store(out, 2, x * y)
    rows.store(out, 3, x / y)
    rows.store(out, 4, -x)
    rows.store(out, 5, operations.magnitude(x))
    rows.store(out, 6, operations.select((x < y) & ~(x == y), x * 2.0, 3.0 - y))
    rows.store(out, 7, operations.lane_numbers(like))


@njit
def _arithmetic8(a, b, out):
    _arithmetic(operations.zeros8(), a, b, out)


@njit
def _arithmetic1(a, b, out):
    _arithmetic(operations.zeros1(), a, b, out)


@given(EIGHT, EIGHT)
def test_operations_are_those_of_doubles(a, b):
    out = np.empty(64)
    _arithmetic8(a, b, out)
    with np.errstate(all="ignore"):
        expected = np.array(
            [a + b, a - b, a * b, a / b, -a, abs(a), np.where(a < b, a * 2, 3 - b), np.arange(8.0)]
        )
    np.testing.assert_array_equal(out.reshape(8, 8), expected)


@given(EIGHT, EIGHT, st.integers(0, 7))
def test_a_lane_knows_nothing_of_the_others(a, b, lane):
    together, alone = np.empty(64), np.empty(8)
    _arithmetic8(a, b, together)
    _arithmetic1(a[lane : lane + 1].copy(), b[lane : lane + 1].copy(), alone)
    np.testing.assert_array_equal(together.reshape(8, 8)[:7, lane], alone[:7])


@njit
def _bits(a, b):
    like = operations.zeros8()
    mask = rows.load(like, rows.pointer_to(a), 0) < rows.load(like, rows.pointer_to(b), 0)
    return operations.lane_bits(mask), operations.any_lane(mask)


@given(EIGHT, EIGHT)
def test_masks_become_bits(a, b):
    bits, some = _bits(a, b)
    assert bits == sum(1 << lane for lane in range(8) if a[lane] < b[lane])
    assert some == bool((a < b).any())


@njit
def _lowest(bits):
    return operations.lowest_bit(bits)


@given(st.integers(1, 255))
def test_lowest_bit(bits):
    assert _lowest(bits) == (bits & -bits).bit_length() - 1


@njit
def _coarse(a, out):
    like = operations.zeros8()
    x = rows.load(like, rows.pointer_to(a), 0)
    out = rows.pointer_to(out)
    rows.store(out, 0, operations.coarse_log2(x))
    rows.store(out, 1, operations.coarse_exp2(operations.coarse_log2(x)))


@given(st.lists(st.floats(1e-290, 1e290), min_size=8, max_size=8).map(np.array))
def test_coarse_logarithm_is_within_its_bound_and_inverted(a):
    out = np.empty(16)
    _coarse(a, out)
    exact = np.log2(a)
    assert (out[:8] <= exact + 1e-12 * abs(exact) + 1e-12).all()
    assert (out[:8] >= exact - operations.COARSENESS).all()
    np.testing.assert_allclose(out[8:], a, rtol=1e-12)


@njit
def _rows(source, target):
    like = operations.zeros8()
    rows.store(rows.pointer_to(target), 1, rows.load(like, rows.pointer_to(source), 2))
    rows.store_at(target, 19, operations.spread(like, 7.0))


def test_rows_and_places_of_an_array():
    target = np.zeros(32)
    _rows(np.arange(32.0), target)
    expected = np.zeros(32)
    expected[8:16] = np.arange(16.0, 24.0)
    expected[19:27] = 7.0
    np.testing.assert_array_equal(target, expected)
