"""What the checks of the claims measure on thresholds, and on the printed numbers."""

import pytest

from gearmesh.data import paths
from gearmesh.reproduction.claims import (
    DEVIATES,
    NOT_TESTABLE,
    REPRODUCED,
    Evidence,
    checking,
    fig2,
    fig3,
    fig4,
    fig5,
    fig6,
    fig7,
    load_ledger,
    printed,
    verdict,
)
from gearmesh.reproduction.claims.checking import check_figure

FIGURES = ("printed", *paths.NOTEBOOK_NAMES)


@pytest.fixture(scope="module")
def ledger(root):
    return load_ledger(root / paths.CLAIMS)


def test_every_claim_has_its_measure_and_every_measure_its_claim(ledger):
    assert [c.id for c in ledger] == list(checking.MEASURES)


def test_a_claim_is_checked_by_the_figure_it_belongs_to(ledger):
    modules = {"printed": printed, "fig2": fig2, "fig3": fig3, "fig4": fig4}
    modules |= {"fig5": fig5, "fig6": fig6, "fig7": fig7}
    for c in ledger:
        assert c.id in modules[c.figure].MEASURES


def test_the_printed_numbers_hold(ledger, pair):
    entries = check_figure("printed", Evidence(pair=pair), ledger)
    assert {e.id: e.status for e in entries} == {f"P{n}": REPRODUCED for n in range(1, 10)}


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        ({"damping": "4.2 N s/mm"}, {"P3"}),
        ({"stiffness_ratio": 0.6}, {"P1", "P2", "P3", "P4"}),
        ({"pressure_angle": "21 deg"}, {"P6"}),
        # Constant stiffness excites nothing: there is no tongue to find.
        ({"stiffness_ratio": 1.0}, {"P1", "P2", "P3", "P4", "P5", "P8"}),
        ({"contact_ratio": 1.7}, {"P1", "P3", "P4", "P7"}),
    ],
)
def test_another_parameter_breaks_the_printed_numbers_it_enters(ledger, pair, change, broken):
    evidence = Evidence(pair=pair.replace(**change))
    entries = check_figure("printed", evidence, ledger)
    assert {e.id for e in entries if e.status == DEVIATES} == broken


def test_in_an_empty_study_nothing_is_testable_and_nothing_unexpected(ledger, pair):
    evidence = Evidence(pair=pair)
    entries = [e for figure in FIGURES[1:] for e in check_figure(figure, evidence, ledger)]
    assert {e.status for e in entries} == {NOT_TESTABLE}
    assert verdict(entries).unexpected == ()


LUBRICANT = ("b-lubricant", "c-lubricant", "d-lubricant", "h-lubricant")
MISSING = {
    "first_jump": dict.fromkeys(LUBRICANT),
    "second_jump": dict.fromkeys(LUBRICANT),
    "peak": {name: {"nu": None, "y_max": None} for name in LUBRICANT},
    "lowest": dict.fromkeys(LUBRICANT),
    "onset_maxima": dict.fromkeys(LUBRICANT),
    "onset_minima": dict.fromkeys(LUBRICANT),
    "onset_strobes": dict.fromkeys(LUBRICANT),
    "largest_rise": dict.fromkeys(LUBRICANT),
    "loss_gained": {name: {"first": None, "second": None} for name in LUBRICANT},
    "maxima_spread": {name: {"below": None, "above": None} for name in LUBRICANT},
    "band": {name: {"smooth": None, "growth": None} for name in LUBRICANT},
    "strobe_spread": {name: {"0.60": None, "1.05": None, "1.20": None} for name in LUBRICANT},
    "largest_step": {name: {"nu": None, "step": None} for name in fig2.IN_MATERIAL},
    "jumps": {"b-material": [], "b-both": []},
    "material_or_both": dict.fromkeys("cdh"),
    "course_spread": {"below": None, "above": None},
    "loop_end": {"c-material": None, "c-material-5x": None},
    "loop_place": {"c-material": None, "c-material-5x": None},
    "turning_points_before": {"c-material": None, "c-material-5x": None},
    "turning_points_beyond": {"c-material": None, "c-material-5x": None},
    "exceedance": {"c-material-5x": []},
}


def test_thresholds_that_do_not_exist_deviate(ledger, pair):
    evidence = Evidence(pair=pair, thresholds=MISSING)
    entries = [e for figure in FIGURES[1:6] for e in check_figure(figure, evidence, ledger)]
    assert {e.id for e in entries if e.status != DEVIATES} == {"F4.2"}  # needs time courses


def test_the_interval_of_exceedance_is_the_one_around_the_papers_place(pair):
    intervals = [[0.6, 0.605], [0.608, 0.62], [0.7, 0.8]]
    evidence = Evidence(pair=pair, thresholds={"exceedance": {"c-material-5x": intervals}})
    assert fig6.more_damped_exceeds(evidence)[0] == {"from": 0.608, "to": 0.62}


@pytest.mark.parametrize(("place", "distance"), [(0.2845, 0.0), (0.7135, 0.002), (0.98, 0.2645)])
def test_the_distance_of_a_loop_from_the_nearest_switch(pair, place, distance):
    evidence = Evidence(pair=pair, thresholds={"loop_place": {"c-material": place}})
    assert fig5.distance_to_switch(evidence, "c-material") == pytest.approx(distance)


def test_peaks_are_measured_from_the_jump_and_from_the_peak_of_c(pair):
    peaks = {"c-lubricant": 0.77, "d-lubricant": 0.80, "h-lubricant": 0.82}
    evidence = Evidence(
        pair=pair,
        thresholds={
            "peak": {name: {"nu": nu, "y_max": 3.0} for name, nu in peaks.items()},
            "second_jump": {"c-lubricant": 0.77, "d-lubricant": 0.78, "h-lubricant": 0.79},
        },
    )
    measured, _ = fig2.rounded_peaks(evidence)
    assert measured["beyond the jump"] == pytest.approx({"d-lubricant": 0.02, "h-lubricant": 0.03})
    beyond_c = measured["beyond the peak of c"]
    assert beyond_c == pytest.approx({"d-lubricant": 0.03, "h-lubricant": 0.05})
