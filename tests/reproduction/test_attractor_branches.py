"""Every periodic motion on which a run ends lies on a branch, whatever its period."""

from dataclasses import replace

import numpy as np
import pytest
from orbits_in_tables import distance

import gearmesh as gm
from gearmesh.dynamics.attraction.classification import classify
from gearmesh.dynamics.attraction.kinds import PERIODIC
from gearmesh.dynamics.periodic.orbits import correct
from gearmesh.model.variants import variant
from gearmesh.reproduction.mechanisms import tables
from gearmesh.reproduction.mechanisms.attractors import (
    all_branches,
    carried_over,
    further,
    holds,
    reached,
)
from gearmesh.reproduction.mechanisms.orbits import WITHOUT_SUPPORTS
from gearmesh.solvers.simulation import simulate

NAME = "c-lubricant"
NUS = np.round(np.linspace(0.7, 0.765, 27), 4)
LIMITS = float(NUS[0]), float(NUS[-1])


@pytest.fixture(scope="module")
def found(pair):
    return all_branches(pair, NAME, LIMITS, reached(pair, NAME, NUS)[1])


def test_isolas_of_longer_periods_are_found_and_closed_between_their_folds(found):
    isolas = {branch.orbit.periods: branch for branch in found if branch.ends[0] == "closed"}
    assert set(isolas) >= {3, 5}
    for isola in isolas.values():
        assert isola.found.stable.any() and not isola.found.stable.all()
        folds = [point for point in isola.special if point.kind == "fold"]
        ends = [isola.found.values.min(), isola.found.values.max()]
        assert sorted(point.nu for point in folds) == pytest.approx(ends, abs=1e-4)
        for fold in folds:
            assert np.abs(fold.orbit.multipliers - 1.0).min() < 1e-5
        places = [(point.kind, round(point.nu, 9)) for point in isola.special]
        assert len(set(places)) == len(places)  # the place where the branch closes counts once


def test_an_orbit_that_cannot_be_followed_does_not_cost_the_others(pair):
    outside, inside = (gm.find_orbit(pair, NAME, nu) for nu in (0.9, 0.75))
    (branch,) = further([], [outside, inside], LIMITS)
    assert branch.orbit is inside


def test_what_remains_of_a_long_run_lies_on_a_branch(pair, found):
    """Runs of 200 revolutions, where orbits of several periods attract."""
    nus = [0.705, 0.72, 0.735, 0.76]
    runs = [pair.replace(revolutions=200).problem(variant(NAME), nu) for nu in nus]
    for nu, response in zip(nus, simulate(runs, estimate_errors=False), strict=True):
        ends = [
            (here.y_max, here.y_min)
            for branch in found
            for here in (at(branch, nu) if branch.orbit.periods > 2 else ())
        ]
        away = np.abs(np.array(ends) - [response.y_max, response.y_min]).max(axis=1)
        assert away.min() < 1e-6


def at(branch, nu):
    """Return the orbits of a branch at a frequency, found from the points beside it."""
    away = branch.found.values - nu
    for i in np.flatnonzero(away[:-1] * away[1:] <= 0.0).tolist():
        share = away[i] / (away[i] - away[i + 1])
        here, there = (branch.found.orbits[k] for k in (i, i + 1))
        state = here.state + share * (there.state - here.state)
        yield correct(replace(here.problem, nu=nu), state, branch.orbit.periods)


def test_every_stable_orbit_that_a_case_approaches_is_on_a_branch(pair, found):
    """The exceptions are runs that are near no stable orbit of at most 12 periods in the end."""
    runs = classify([pair.problem(variant(NAME), float(nu)) for nu in NUS])
    orbits = [run.orbit for run in runs if run.orbit is not None]
    assert {orbit.periods for orbit in orbits} >= {3, 4, 5}
    assert all(run.orbit is not None for run in runs if run.attractor.kind == PERIODIC)
    table = tables.table({NAME: found}, pair.static_deflection)
    assert max(distance(table, orbit) for orbit in orbits) < 5e-3


def test_an_orbit_on_a_branch_begins_no_other(found):
    isola = next(branch for branch in found if branch.orbit.periods == 3)
    along = [isola.at(i) for i in range(0, len(isola.found.values), 7)]
    assert all(holds(isola, orbit) for orbit in along)
    assert not list(further(found, along, LIMITS))


def test_no_attractor_is_missing_without_friction_on_rigid_supports(pair):
    """Those of b-□ are found again by runs, which know nothing of the other pair's branches."""
    name, nus = "b-material", np.linspace(1.0, 1.2, 33)
    limits, simpler = (1.0, 1.2), pair.replace(**WITHOUT_SUPPORTS)
    known = all_branches(pair, name, limits, reached(pair, name, nus)[1])
    again = all_branches(simpler, name, limits, carried_over(known, simpler))
    _, runs = reached(simpler, name, nus)
    assert {orbit.periods for orbit in runs} == {1, 2}
    assert all(sum(holds(branch, orbit) for branch in again) == 1 for orbit in runs)
    kinds = [(point.kind, point.orbit.periods) for branch in again for point in branch.special]
    assert kinds.count(("fold", 2)) == kinds.count(("grazing_back", 2)) == 2
