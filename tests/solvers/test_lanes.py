"""SIMD lanes: every operation is that of a single double, in every lane."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from gearmesh.solvers import lanes

NUMBERS = st.floats(-1e100, 1e100, allow_nan=False)
EIGHT = st.lists(NUMBERS, min_size=8, max_size=8).map(np.array)


@njit
def _arithmetic(like, a, b, out):
    a, b, out = lanes.pointer_to(a), lanes.pointer_to(b), lanes.pointer_to(out)
    x = lanes.load(like, a, 0)
    y = lanes.load(like, b, 0)
    lanes.store(out, 0, x + y)
    lanes.store(out, 1, x - y)
    lanes.store(out, 2, x * y)
    lanes.store(out, 3, x / y)
    lanes.store(out, 4, -x)
    lanes.store(out, 5, lanes.magnitude(x))
    lanes.store(out, 6, lanes.select((x < y) & ~(x == y), x * 2.0, 3.0 - y))
    lanes.store(out, 7, lanes.lane_numbers(like))


@njit
def _arithmetic8(a, b, out):
    _arithmetic(lanes.zeros8(), a, b, out)


@njit
def _arithmetic1(a, b, out):
    _arithmetic(lanes.zeros1(), a, b, out)


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
    like = lanes.zeros8()
    mask = lanes.load(like, lanes.pointer_to(a), 0) < lanes.load(like, lanes.pointer_to(b), 0)
    return lanes.lane_bits(mask), lanes.any_lane(mask)


@given(EIGHT, EIGHT)
def test_masks_become_bits(a, b):
    bits, some = _bits(a, b)
    assert bits == sum(1 << lane for lane in range(8) if a[lane] < b[lane])
    assert some == bool((a < b).any())


@njit
def _lowest(bits):
    return lanes.lowest_bit(bits)


@given(st.integers(1, 255))
def test_lowest_bit(bits):
    assert _lowest(bits) == (bits & -bits).bit_length() - 1


@njit
def _coarse(a, out):
    like = lanes.zeros8()
    x = lanes.load(like, lanes.pointer_to(a), 0)
    out = lanes.pointer_to(out)
    lanes.store(out, 0, lanes.coarse_log2(x))
    lanes.store(out, 1, lanes.coarse_exp2(lanes.coarse_log2(x)))


@given(st.lists(st.floats(1e-290, 1e290), min_size=8, max_size=8).map(np.array))
def test_coarse_logarithm_is_within_its_bound_and_inverted(a):
    out = np.empty(16)
    _coarse(a, out)
    exact = np.log2(a)
    assert (out[:8] <= exact + 1e-12 * abs(exact) + 1e-12).all()
    assert (out[:8] >= exact - lanes.COARSENESS).all()
    np.testing.assert_allclose(out[8:], a, rtol=1e-12)


@njit
def _rows(source, target):
    like = lanes.zeros8()
    lanes.store(lanes.pointer_to(target), 1, lanes.load(like, lanes.pointer_to(source), 2))
    lanes.store_at(target, 19, lanes.spread(like, 7.0))


def test_rows_and_places_of_an_array():
    target = np.zeros(32)
    _rows(np.arange(32.0), target)
    expected = np.zeros(32)
    expected[8:16] = np.arange(16.0, 24.0)
    expected[19:27] = 7.0
    np.testing.assert_array_equal(target, expected)
