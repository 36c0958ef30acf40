"""A feature that depends on a failed run is not located, and the run is named."""

import numpy as np
import pytest
from curves import Drawn, heights
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.dynamics import response_curves as curves
from gearmesh.dynamics.response_curves import WIDTH, FailedRun
from gearmesh.solvers.response import MAXIMUM


def named(nu):
    return pytest.raises(FailedRun, match=rf"^the run of c-lubricant at nu_s = {nu}: step_limit$")


def split_from(onset, failed=()):
    """Draw a curve whose maxima lie apart from an onset on."""

    def extrema(nu):
        apart = 1.0 if nu > onset else 0.0
        return {
            "extremum_time": np.array([0.5, 1.5]),
            "extremum_y": np.array([1.0, 1.0 + apart]),
            "extremum_kind": np.array([1, 1], np.int8),
        }

    return Drawn(extrema, failed)


def onset_of(curve):
    return curves.onset(curve, curve.of(curves.extremum_spread(MAXIMUM)), 1.0, 1.2)


def test_the_features_are_located_while_no_run_fails():
    assert onset_of(split_from(1.1111)) == pytest.approx(1.1111, abs=WIDTH)
    (jump,) = curves.jumps(heights(lambda nu: 1.0 + (nu > 0.64943)), 0.6, 1.0)
    assert jump.nu == pytest.approx(0.64943, abs=WIDTH)


@pytest.mark.parametrize("failed", [1.15, 1.2, 1.1125, 1.1])
def test_a_failed_run_neither_moves_nor_hides_an_onset(failed):
    with named(failed):
        onset_of(split_from(1.1111, [failed]))


@pytest.mark.parametrize("failed", [0.65, 0.6475, 0.9])
def test_a_failed_run_does_not_hide_a_jump(failed):
    with named(failed):
        curves.jumps(heights(lambda nu: 1.0 + (nu > 0.64943), [failed]), 0.6, 1.0)


@pytest.mark.parametrize("which", [0, 1])
def test_a_failed_run_of_either_curve_does_not_split_an_interval_of_exceedance(which):
    shapes = [lambda nu: float(0.605 < nu < 0.63), lambda nu: 0.5]
    both = [heights(shape, [0.615] if i == which else []) for i, shape in enumerate(shapes)]
    with named(0.615):
        curves.exceedance(*both, 0.6, 0.8)


@pytest.mark.parametrize(
    "search",
    [
        lambda curve: curves.jumps(curve, 0.6, 1.2),
        lambda curve: curves.largest_step(curve, 0.6, 1.2),
        lambda curve: curves.peak(curve, 0.6, 1.2),
        lambda curve: curves.largest_rise(curve, 0.6, 1.2),
        lambda curve: curves.loop_end(curve, 0.6, 1.2),
        lambda curve: curves.relative_difference(curve, heights(lambda nu: 1.0), 0.6, 1.2),
        lambda curve: curves.relative_difference(heights(lambda nu: 1.0), curve, 0.6, 1.2),
        lambda curve: curves.typical_spread([heights(lambda nu: 1.0), curve], 0.6, 1.2),
    ],
)
@given(st.sampled_from(curves.scan(0.6, 1.2).tolist()))
def test_no_search_passes_over_a_failed_run_of_its_scan(search, failed):
    curve = heights(lambda nu: 1.0 + (nu > 0.70001), [failed])
    with named(f"{failed:.10g}"):
        search(curve)


class FailsBetween(Drawn):
    """A curve whose runs fail between two places, but not on the scan."""

    def __init__(self, draw, low, high):
        super().__init__(draw)
        self._low, self._high = low, high

    def at(self, nu):
        self._failed = [x for x in nu if self._low < x < self._high]
        return super().at(nu)


def test_a_failed_run_inside_a_bracket_counts_too():
    def jumping(nu):
        return {"y_max": 1.0 + (nu > 0.64943)}

    with pytest.raises(FailedRun, match=r"c-lubricant at nu_s = 0\.6[45]"):
        curves.jumps(FailsBetween(jumping, 0.6476, 0.6499), 0.6, 1.0)
    below = FailsBetween(jumping, 0.6476, 0.6499), heights(lambda nu: 1.5)
    with pytest.raises(FailedRun, match=r"c-lubricant at nu_s = 0\.6[45]"):
        curves.exceedance(*below, 0.6, 0.8)
    # A gap that no search asks for does no harm.
    assert len(curves.jumps(FailsBetween(jumping, 0.8001, 0.8024), 0.6, 1.0)) == 1
