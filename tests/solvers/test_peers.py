"""The solver against heyoka's Taylor method, over whole runs of all 105 mesh periods.

heyoka integrates the reduced equations to rounding; they are written for it in `benchmarks`,
apart from the library. Extrema, strobe points and samples have to agree wherever the orbit does
not blow up what is below any solver's reach: the runs here are none of those, and that is
tested too.
"""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from gearmesh.model.variants import VARIANTS, variant
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.derivatives.variational import REGIME
from gearmesh.study.loading import load_study

pytest.importorskip("heyoka", reason="heyoka is not installed: its wheels are for Linux only")

from benchmarks.orbits import heyoka_lanes, heyoka_map
from benchmarks.outcome import deviation
from benchmarks.peers import OURS, PEERS
from benchmarks.reference import references

ROOT = Path(__file__).parents[2]
AGREEMENT = 1e-8
TIGHT = 1e-13


PAIR = load_study(ROOT / "config" / "paper.yaml").pair.replace(
    backlash="40 um",
    damping_length="5 um",
    body_mass="100 kg",
    bearing_stiffness="3.29e5 N/mm",
    bearing_damping_ratio=0.03,
    friction_coefficient=0.05,
    initial_phase=0,
)
"""Assumptions of their own, so that what the study assumes can change."""


def problem(name, nu, **changes):
    return replace(PAIR.problem(variant(name), nu), **changes)


GRAZING = problem("c-material", 0.857039)
"""Contact is lost by less than 1e-5 static deflections."""

BACK_FLANK = problem("c-lubricant", 1.0, backlash=0.6)

RUNS = {name: problem(name, 1.0) for name in VARIANTS} | {
    "grazing": GRAZING,
    "back-flank contact": BACK_FLANK,
    "back-flank contact, both": problem("b-both", 0.9, backlash=0.6),
    "near the jump": problem("c-lubricant", 0.655),
    "normal mesh throughout": problem("b-material", 0.66),
    "strong friction": problem("c-material", 0.8, friction_coefficient=0.3),
    "no friction": problem("h-both", 0.8, friction_coefficient=0.0),
    "another phase at the start": problem("d-both", 0.7, initial_phase=0.3),
    "start at a switch": problem("c-lubricant", 0.8, initial_phase=0.2845),
    "five times the damping": problem("c-material-5x", 0.61),
    "light bodies on soft bearings": problem("e-both", 0.85, body_mass=5.0, bearing_stiffness=0.3),
}


@pytest.fixture(scope="module")
def known():
    return dict(zip(RUNS, references(list(RUNS.values())), strict=True))


@pytest.mark.parametrize("name", RUNS)
def test_agrees_with_heyoka_over_the_whole_run(name, known):
    assert not known[name].sensitive
    (outcome,) = OURS.load()([RUNS[name]], TIGHT)
    found = deviation(outcome, known[name].outcome)
    assert found.extrema_agree
    assert found.error < AGREEMENT


def test_runs_visit_what_they_are_named_for(known):
    assert -1e-5 < known["grazing"].outcome.extremum_y.min() < 0
    assert known["back-flank contact"].outcome.sample_y.min() < -BACK_FLANK.backlash
    assert known["normal mesh throughout"].outcome.sample_y.min() > 0


def test_displacement_of_the_start_shows_which_orbits_are_sensitive():
    chaotic, damped = references([problem("a-conservative", 0.62), problem("b-both", 0.9)])
    assert chaotic.sensitive
    assert not damped.sensitive


def test_tighter_tolerance_comes_closer(known):
    names = [name for name in VARIANTS if not name.startswith("a")]
    errors = [
        [
            deviation(outcome, known[name].outcome).error
            for name, outcome in zip(
                names, OURS.load()([RUNS[name] for name in names], tolerance), strict=True
            )
        ]
        for tolerance in (1e-8, 1e-10, 1e-12)
    ]
    for coarse, fine in pairwise(np.median(errors, axis=1)):
        assert fine < coarse / 10


@pytest.mark.parametrize("solver", PEERS, ids=lambda solver: solver.module)
def test_peer_solves_the_same_problem(solver, known):
    try:
        solve = solver.load()
    except ImportError as error:
        pytest.skip(f"{solver.name} is not installed: {error}")
    bound = 1e-2 if solver.module == "rk4" else AGREEMENT
    names = ("grazing", "back-flank contact", "no friction", "start at a switch")
    for name in names:
        (outcome,) = solve([RUNS[name]], solver.settings[-1])
        found = deviation(outcome, known[name].outcome)
        assert found.extrema_agree, name
        assert found.error < bound, name


@pytest.mark.parametrize("name", ["b-both", "c-material", "d-both"])
def test_a_period_and_its_jacobian_agree_with_heyoka(name):
    """From states in all regimes, one more than fit into whole batches."""
    n = 2 * heyoka_lanes.LANES + 1
    problems = [problem(name, nu, backlash=0.6) for nu in np.linspace(0.7, 1.1, n)]
    states = np.random.default_rng(1).uniform([-2, -2, -1e-3, -1e-3], [3, 2, 1e-3, 1e-3], (n, 4))
    moved = [passage(one, state) for one, state in zip(problems, states, strict=True)]
    assert {-1, 0, 1} <= {regime for one in moved for regime in one.events[:, REGIME]}
    ends, jacobians = heyoka_lanes.Stroboscopes(problems)(np.arange(n), states)
    for i, ours in enumerate(moved):
        one_by_one = heyoka_map.Stroboscope(problems[i])(states[i])
        for end, jacobian in ((ends[i], jacobians[i]), one_by_one):
            assert np.abs(end - ours.end).max() < 1e-12
            assert np.abs(jacobian - ours.jacobian).max() < 1e-12
