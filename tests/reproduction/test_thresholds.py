"""The thresholds of the paper, and what becomes of them when a run fails."""

import json
from dataclasses import replace

import numpy as np
import pytest
from curves import Drawn

from gearmesh.data import paths
from gearmesh.dynamics.response_curves import JUMP_WIDTH, WIDTH, FailedRun
from gearmesh.model.variants import variant
from gearmesh.reproduction import thresholds
from gearmesh.reproduction.claims import NOT_TESTABLE, Evidence, load_ledger
from gearmesh.reproduction.claims.checking import check_figure
from gearmesh.solvers.simulation import simulate

NAMES = ("c-material", "c-material-5x", "c-lubricant")


@pytest.fixture(scope="module")
def located(pair):
    return thresholds.locate(pair, NAMES)


def test_thresholds_of_the_paper_stand_where_the_model_changes(pair, located):
    assert json.loads(json.dumps(located, allow_nan=False)) == located

    def run(name, nu):
        return simulate([pair.problem(variant(name), nu)], pair.tolerance)[0]

    end = located["loop_end"]["c-material"]
    assert run("c-material", end - WIDTH).turning_points_per_period == 4
    assert run("c-material", end + WIDTH).turning_points_per_period == 2

    jump = located["second_jump"]["c-lubricant"]
    below, above = (run("c-lubricant", jump + side).y_max for side in (-JUMP_WIDTH, JUMP_WIDTH))
    assert above - below > 0.5

    low, high = located["exceedance"]["c-material-5x"][0]
    middle = (low + high) / 2
    assert run("c-material-5x", middle).y_max > run("c-material", middle).y_max
    beyond = high + WIDTH
    assert run("c-material-5x", beyond).y_max < run("c-material", beyond).y_max


def test_what_a_study_does_not_have_is_left_out(pair):
    assert thresholds.locate(pair, ["a-conservative"]) == {}
    found = thresholds.locate(pair, ["d-material"])
    assert found.keys() == {"largest_step"}


def test_the_last_loop_closes_at_its_smallest_pair_of_extrema():
    def extrema(nu):
        return {
            "extremum_time": np.array([0.10, 0.30, 0.32, 0.70]),
            "extremum_y": np.array([0.2, 1.3, 1.29, 1.6]),
        }

    assert thresholds.loop_place(Drawn(extrema), 0.64, 0.9) == pytest.approx(0.21)
    with pytest.raises(FailedRun, match=r"at nu_s = 0\.6399: step_limit"):
        thresholds.loop_place(Drawn(extrema, [0.64 - WIDTH]), 0.64, 0.9)


def locate_with_failure(pair, name, nu):
    """Locate the thresholds of real curves, one run of which fails."""
    known = {each: thresholds.curve_of(pair, each) for each in NAMES}
    honest = known[name].at

    def at(places):
        return [
            replace(response, status="step_limit") if x == nu else response
            for x, response in zip(places, honest(places), strict=True)
        ]

    known[name].at = at
    return thresholds.locate_on(known, pair)


FAILURES = [
    ("c-lubricant", 1.15, "onset_maxima", "c-lubricant", "F3.1"),
    ("c-lubricant", 1.2, "onset_minima", "c-lubricant", "F3.1"),
    ("c-lubricant", 0.65, "first_jump", "c-lubricant", "F2.3"),
    ("c-material", 0.61, "exceedance", "c-material-5x", "F6.1"),
]
"""Runs whose failure moved, hid or split a threshold when searches passed over it."""


@pytest.mark.parametrize(("name", "nu", "observable", "of", "claim"), FAILURES)
def test_a_failed_run_leaves_its_thresholds_unlocated_and_their_claims_not_testable(
    root, pair, located, name, nu, observable, of, claim
):
    found = locate_with_failure(pair, name, nu)
    why = f"the run of {name} at nu_s = {nu:.10g}: step_limit"
    assert found[observable][of] == {"not_located": why}
    for other, values in located.items():
        for key, value in values.items():
            assert found[other][key] in (value, {"not_located": why}), (other, key)

    # The thresholds of all other variants have values that the ledger does not read in this test.
    others = dict.fromkeys(("b-lubricant", "c-lubricant", "d-lubricant", "h-lubricant"), 1.0)
    known = {name: dict(others) for name in ("onset_maxima", "onset_minima", "first_jump")}
    known.setdefault(observable, {})[of] = found[observable][of]
    evidence = Evidence(pair=pair, thresholds=known)
    entries = check_figure(f"fig{claim[1]}", evidence, load_ledger(root / paths.CLAIMS))
    (entry,) = (entry for entry in entries if entry.id == claim)
    assert entry.status == NOT_TESTABLE
    assert entry.detail == f"not located: {observable} of {of}: {why}"
    assert entry.unexpected
