"""Functions on floats and on numbers that bring their own."""

import math

import pytest

from gearmesh.model.functions import (
    Harmonic,
    cosine,
    harmonic_rate,
    harmonic_sum,
    sine,
    square_root,
)

HARMONICS = (Harmonic(1, 0.3, -0.2), Harmonic(0.25, 0.7, 0.4), Harmonic(0, 1.5, 9.0))


class Traced:
    """A number that records what is done with it."""

    def sin(self):
        return "its sine"

    def cos(self):
        return "its cosine"

    def sqrt(self):
        return "its square root"


def test_functions_of_floats_and_of_other_numbers():
    assert (sine(0.3), cosine(0.3), square_root(0.3)) == (
        *(math.sin(0.3), math.cos(0.3), math.sqrt(0.3)),
    )
    other = Traced()
    assert (sine(other), cosine(other), square_root(other)) == (
        *("its sine", "its cosine", "its square root"),
    )


@pytest.mark.parametrize("time", [0.0, 1.3, -4.0])
def test_harmonics_are_added_up_and_their_rate_is_the_slope(time):
    nu = 0.7
    angle = nu * time
    expected = 0.3 * math.cos(angle) - 0.2 * math.sin(angle) + 1.5
    expected += 0.7 * math.cos(0.25 * angle) + 0.4 * math.sin(0.25 * angle)
    assert harmonic_sum(HARMONICS, angle) == pytest.approx(expected)
    ahead, behind = (harmonic_sum(HARMONICS, nu * (time + h)) for h in (1e-5, -1e-5))
    assert harmonic_rate(HARMONICS, angle, nu) == pytest.approx((ahead - behind) / 2e-5, abs=1e-9)
    assert harmonic_sum((), angle) == harmonic_rate((), angle, nu) == 0.0
