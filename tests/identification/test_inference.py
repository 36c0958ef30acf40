"""The inference, on toy models whose answers are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmesh.errors import InputError
from gearmesh.identification.estimation import (
    inference,
    prediction,
    sensitivity,
    synthetic,
    wording,
)
from gearmesh.identification.estimation.wording import Statement
from gearmesh.reproduction.claims import Claim, holds

NUMBER = Claim(
    id="F1.1", where="here", figure="fig2", statement="x", kind="threshold",
    expected={"place": 0.64, "lead": {"at_least": 0.001}}, tolerance=0.01,
)  # fmt: skip


measured_values = st.one_of(st.floats(0.6, 0.7), st.just(float("nan")), st.floats(-1e-2, 1e-2))


@given(measured_values, measured_values, measured_values)
def test_what_the_ledger_reproduces_has_weight_and_nothing_else(c, d, lead):
    measured = {"place": {"c": c, "d": d}, "lead": lead}
    columns = {"F1.1|place|c": c, "F1.1|place|d": d, "F1.1|lead": lead}
    weight = wording.weight_of_claims(
        wording.statements([NUMBER]), {name: np.array([x]) for name, x in columns.items()}
    )
    assert (weight["F1.1"][0] > 0) == holds(NUMBER, measured)


def test_a_number_fits_in_full_as_far_as_its_digits_go():
    words = {"claim": "F1.1", "quantity": "place", "words": "0.64", "sure": 0.005, "reason": "r"}
    settings_wording = wording.Wording(**words)
    place, _ = wording.statements([NUMBER], [settings_wording])
    values = np.array([0.64, 0.6449, 0.6475, 0.6501, np.nan])
    np.testing.assert_allclose(place.weight(values), [1, 1, 0.5, 0, 0], atol=1e-6)
    with pytest.raises(InputError, match="no number 'lead'"):
        wording.statements([NUMBER], [wording.Wording(**words | {"quantity": "lead"})])


def test_a_region_without_evidence_is_the_prior():
    places = np.random.default_rng(0).random(4000)
    low, high = inference.region(places, np.full(4000, 1 / 4000))
    assert (low, high) == pytest.approx((0.025, 0.975), abs=0.01)


def test_a_region_closes_in_on_what_fits():
    places = np.random.default_rng(0).random(4000)
    fit = inference.fit([(np.abs(places - 0.3) < 0.05).astype(float)], np.full(4000, 1 / 4000))
    assert fit.forgiven == 0
    low, high = inference.region(places, fit.weights)
    assert (low, high) == pytest.approx((0.25, 0.35), abs=0.01)


def test_claims_that_cannot_hold_together_are_forgiven_one_by_one():
    places = np.linspace(0, 1, 1000)
    low, high = (places < 0.4).astype(float), (places > 0.6).astype(float)
    fit = inference.fit([low, high], np.full(1000, 1e-3))
    assert fit.forgiven == 1
    assert fit.weights[(places > 0.4) & (places < 0.6)].sum() == 0


def test_the_largest_sets_that_hold_together():
    held = {"A": np.array([1, 1, 0, 0]), "B": np.array([1, 1, 1, 0]), "C": np.array([0, 0, 1, 0])}
    held = {name: values.astype(bool) for name, values in held.items()}
    sets = inference.joint_sets(held, np.full(4, 0.25))
    assert [missing for missing, _ in sets] == [("C",), ("A",)]
    assert [meets.tolist() for _, meets in sets] == [[True, True, False, False],
                                                     [False, False, True, False]]  # fmt: skip


@pytest.mark.parametrize(("value", "word"), [(1.0, "robust"), (0.5, "conditional")])
def test_claims_are_named_by_their_share(value, word):
    assert inference.standing(value) == word
    assert inference.standing(0.0) == "contradicted"


def test_sensitivity_tells_what_matters_from_what_does_not():
    rng = np.random.default_rng(7)
    x = rng.random((2048, 3))
    y = np.where(x[:, 0] > 0.8, np.nan, x[:, 0] ** 2 + 0.3 * x[:, 1])
    strong, weak, none = (sensitivity.index(x[:, i], y, 8, 40) for i in range(3))
    assert strong.value > 0.4 > weak.value > weak.chance
    assert strong.value > strong.chance
    assert none.value < 0.1
    assert strong.low <= strong.value <= strong.high


class Toy:
    """A model of three parameters, the third without effect, and a paper about it."""

    factors = ("s", "l", "idle")

    def __init__(self, count: int, seed: int) -> None:
        x = np.random.default_rng(seed).random((count, 3))
        self.places = dict(zip(self.factors, x.T, strict=True))
        self.measured = {
            "F1.1|end": 0.5 + 0.3 * x[:, 0] - 0.1 * x[:, 1],
            "F1.2|jump|c": 0.7 + 0.2 * x[:, 1],
            "F1.2|jump|d": np.where(x[:, 0] > 0.9, np.nan, 0.7 + 0.2 * x[:, 1] ** 2),
            "F1.3": x[:, 0] - x[:, 1],
        }

    stated = (
        Statement("F1.1", "end", 0.59, 0.61, 0.59, 0.61),
        Statement("F1.2", "jump", 0.76, 0.84, 0.76, 0.84),
        Statement("F1.3", "", 0.0, np.inf, 0.0, np.inf),
    )


def test_synthetic_papers_give_their_parameters_back():
    samples, truths = Toy(4000, seed=1), Toy(60, seed=2)
    prior = np.full(4000, 1 / 4000)
    made = [
        synthetic.recover(
            {name: values[i] for name, values in truths.measured.items()},
            {name: values[i] for name, values in truths.places.items()},
            Toy.stated, samples.measured, samples.places, prior,
        )
        for i in range(60)
    ]  # fmt: skip
    assert sum(one.recovered for one in made) >= 54
    # It says something, and nothing about what has no effect.
    assert np.median([one.width["s"] for one in made]) < 0.5
    assert np.median([one.width["idle"] for one in made]) > 0.9


def test_a_model_that_is_wrong_is_not_recovered():
    samples, truths = Toy(4000, seed=1), Toy(20, seed=2)
    recovered = [
        synthetic.recover(
            {name: values[i] for name, values in truths.measured.items()},
            {name: (values[i] + 0.5) % 1.0 for name, values in truths.places.items()},
            Toy.stated, samples.measured, samples.places, np.full(4000, 1 / 4000),
        ).recovered
        for i in range(20)
    ]  # fmt: skip
    assert sum(recovered) <= 5


def test_a_paper_says_no_more_than_the_real_one():
    truth = {"F1.1|end": 0.6049, "F1.2|jump|c": 0.75, "F1.2|jump|d": np.nan, "F1.3": -0.2}
    paper = synthetic.paper(truth, Toy.stated)
    assert paper["F1.1|end"].number == pytest.approx(0.60)
    assert paper["F1.2|jump|c"].number == pytest.approx(0.72)
    assert paper["F1.2|jump|d"] is False
    assert paper["F1.3"] is False


def test_half_of_the_claims_predicts_the_other_half():
    toy = Toy(4000, seed=3)
    weight = wording.weight_of_claims(Toy.stated, toy.measured)
    prior = np.full(4000, 1 / 4000)
    found = prediction.predict(["F1.1", "F1.3"], ["F1.2"], weight, Toy.stated, toy.measured, prior)
    assert found.before["F1.2"] == pytest.approx(np.mean(weight["F1.2"] > 0), abs=1e-3)
    assert found.covered.keys() == {"F1.2|jump|c", "F1.2|jump|d"}
    blind = prediction.predict([], ["F1.2"], weight, Toy.stated, toy.measured, prior)
    assert blind.gain == pytest.approx(0.0, abs=0.01)
    assert blind.narrowed["F1.2|jump|c"] == pytest.approx(1.0)


@given(st.integers(0, 1000))
def test_claims_that_say_the_same_stay_together(seed):
    claims = list("ABCDEFG")
    for first, second in prediction.halves(claims, [("B", "E"), ("F", "X")], 3, seed):
        assert sorted([*first, *second]) == claims
        assert ("B" in first) == ("E" in first)
        assert first and second
