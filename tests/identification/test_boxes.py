"""Focused designs: boxes around samples, and the weights that make all designs an even one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import qmc

from gearmesh.identification.estimation import focus, inference
from gearmesh.identification.factors import FACTORS
from gearmesh.identification.sampling import boxes


@given(st.lists(st.floats(0, 1), min_size=2, max_size=20), st.sampled_from([*FACTORS]))
def test_a_box_holds_what_it_was_spanned_by(places, factor):
    inside = np.minimum(np.array(places), 1 - 1e-9)[:, None]
    box = boxes.box_of(inside, [factor])
    assert 0 <= box.low[0] < 1 and box.length[0] <= 1
    if box.volume > 0:
        np.testing.assert_allclose(box.density(inside), 1 / box.volume)


@pytest.mark.parametrize(
    ("places", "factor", "low", "length"),
    [
        ([0.2, 0.3, 0.4], "backlash", 0.19, 0.22),  # and a twentieth beyond both ends
        ([0.01, 0.99, 0.5], "backlash", 0.0, 1.0),
        ([0.9, 0.1, 0.0], "initial_phase", 0.89, 0.22),  # the shortest arc leads past 1
        ([0.01, 0.1, 0.3], "kind", 0.0, 1 / 3),
        ([0.4, 0.6, 0.01], "kind", 0.0, 2 / 3),
        ([0.1, 0.9], "kind", 2 / 3, 2 / 3),  # the last and the first are neighbours
        ([0.1, 0.5, 0.9], "kind", 0.0, 1.0),
    ],
)
def test_a_box_reaches_as_far_as_its_samples(places, factor, low, length):
    assert boxes.span(np.array(places), factor) == pytest.approx((low, length))


def test_a_box_is_filled_evenly_and_nothing_beside_it():
    box = boxes.Box(np.array([0.25, 0.9, 2 / 3]), np.array([0.5, 0.2, 2 / 3]))
    filled = box.fill(qmc.Sobol(3, seed=1).random(1024))
    np.testing.assert_allclose(box.density(filled), 1 / box.volume)
    assert set((filled[:, 2] * 3).astype(int)) == {0, 2}
    assert np.mean(filled[:, 0] < 0.5) == pytest.approx(0.5, abs=0.01)
    assert np.mean(filled[:, 1] < 0.5) == pytest.approx(0.5, abs=0.01)
    even = np.random.default_rng(1).random((40_000, 3))
    assert box.density(even).mean() == pytest.approx(1.0, abs=0.1)


NINE = (
    *("backlash", "damping_length", "body_mass", "bearing_stiffness", "bearing_damping_ratio"),
    *("friction_coefficient", "initial_phase", "initial_velocity", "kind"),
)


def target(places: np.ndarray) -> np.ndarray:
    """A region of volume 0.2 · 0.4 · 0.3 / 3 = 0.008, across the ends of the phase."""
    x = dict(zip(NINE, places.T, strict=True))
    return (
        (np.abs(x["damping_length"] - 0.5) < 0.1)
        & (x["body_mass"] > 0.6)
        & ((x["initial_phase"] + 0.15) % 1.0 < 0.3)
        & (x["kind"] < 1 / 3)
    )


def focused_twice(meets, seed: int) -> tuple[np.ndarray, np.ndarray, list[boxes.Box]]:
    """Sample as the pipeline does: evenly, then a box around what fits best, then once more."""
    places = qmc.Sobol(len(NINE), seed=seed).random(4096)
    sizes, chain = [4096], []
    for again in (1, 2):
        # What misses the target narrowly is among the best, too, if there is not enough inside.
        score = meets(places) + 0.5 * (np.abs(places[:, 1] - 0.5) < 0.15)
        chain.append(boxes.box_of(places[focus.best(score, np.zeros(len(places)))], NINE))
        drawn = chain[-1].fill(qmc.Sobol(len(NINE), seed=seed + again).random(1024))
        places = np.concatenate([places, drawn])
        sizes.append(1024)
    return places, boxes.prior_weights(places, sizes, chain), chain


def test_volumes_are_found_within_their_errors():
    misses, sizes = [], []
    for seed in range(0, 200, 10):
        places, prior, chain = focused_twice(target, seed)
        found, error = inference.share(target(places), prior)
        misses.append((found - 0.008) / error)
        sizes.append(inference.effective_size(prior * target(places)))
        assert chain[1].volume <= chain[0].volume < 0.5
        # The whole space, and a part that the boxes cut: the prior is as even as before.
        np.testing.assert_allclose(prior @ places, 0.5, atol=0.02)
        assert inference.share(places[:, 1] < 0.45, prior)[0] == pytest.approx(0.45, abs=0.02)
    # No sample may be missed at the rim of the boxes: it would make all volumes too small.
    assert abs(np.mean(misses)) < 0.4
    assert np.sum(np.abs(misses) < 2) >= 19
    # As many samples, all of them even, would have 0.008 of their number in the target.
    assert np.mean(sizes) > 3 * 0.008 * 6144


def test_a_region_outside_the_box_keeps_its_share():
    # Two islands, of which the box knows one: the other is left to the even design.
    islands = [boxes.Box(np.array([low, 0.0]), np.array([0.1, 0.1])) for low in (0.1, 0.8)]
    even = qmc.Sobol(2, seed=1).random(4096)
    places = np.concatenate([even, islands[0].fill(qmc.Sobol(2, seed=2).random(1024))])
    prior = boxes.prior_weights(places, [4096, 1024], islands[:1])
    for island in islands:
        found, error = inference.share(island.density(places) > 0, prior)
        assert abs(found - 0.01) < 3 * error


def test_the_best_meet_most_claims():
    held, fit = np.array([3, 5, 5, 1]), np.array([9.0, 0.1, 0.2, 9.9])
    assert focus.best(held, fit, 3).tolist() == [2, 1, 0]
