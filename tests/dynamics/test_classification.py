"""The long-run motion of many cases, against long runs and orbits that are found otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from problems import of_paper, problem

from gearmesh.dynamics.attraction.classification import SETTLED, classify
from gearmesh.dynamics.attraction.envelopes import envelope_of
from gearmesh.dynamics.attraction.kinds import CHAOTIC, LOST, MOVING, NEUTRAL, PERIODIC
from gearmesh.dynamics.periodic.orbits import find_orbit
from gearmesh.dynamics.starts import initial_coordinates, linear_orbit
from gearmesh.model.problem import State
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.derivatives.variational import REGIME, TIME
from gearmesh.solvers.simulation import simulate

CASES = {
    "one period": problem(0.7, "c-material"),
    "contact loss": problem(0.9, "c-lubricant"),
    "two periods": of_paper("c-lubricant", 0.66),
    "in contact at last": problem(1.18, "c-lubricant", bearing_damping_ratio=0.1),
    "for ever shallower": of_paper("c-lubricant", 1.15),
    "chaos": of_paper("a-conservative", 1.0, initial_displacement="3.5 y_st"),
    "regular": of_paper("a-conservative", 0.7),
    "runs away": problem(0.7, material=(-50.0, 0.0, 0.0), backlash=1e12),
}


@pytest.fixture(scope="module")
def found():
    return dict(zip(CASES, classify(list(CASES.values())), strict=True))


def test_every_kind_is_told(found):
    kinds = {name: one.attractor.kind for name, one in found.items()}
    assert kinds == {
        "one period": PERIODIC,
        "contact loss": PERIODIC,
        "two periods": PERIODIC,
        "in contact at last": NEUTRAL,
        "for ever shallower": MOVING,
        "chaos": CHAOTIC,
        "regular": NEUTRAL,
        "runs away": LOST,
    }


@pytest.mark.parametrize(
    ("name", "periods"), [("one period", 1), ("contact loss", 1), ("two periods", 2)]
)
def test_a_run_settles_on_an_orbit_when_a_simulation_does(found, name, periods):
    case, (attractor, settled, _) = CASES[name], found[name]
    assert attractor.orbit.periods == periods
    orbit = find_orbit(case, periods, attractor.orbit.state)
    [run] = simulate([replace(case, revolutions=20)], estimate_errors=False)
    last = len(run.strobe_y) - 1
    away = []
    for n in range(last, last - periods, -1):
        points = [orbit.state]
        for _ in range(periods - 1):
            points.append(passage(case, points[-1]).end)
        order = (np.arange(last + 1) - n) % periods
        near = np.array(points)[order, :2] - np.column_stack([run.strobe_y, run.strobe_v])
        away.append(np.abs(near).max(axis=1) >= SETTLED)
    best = min(away, key=lambda far: int(far.sum()))
    assert settled == np.flatnonzero(best)[-1] + 1


def test_motion_that_is_neutral_was_not_before_it_settled(found):
    case, (attractor, settled, _) = CASES["in contact at last"], found["in contact at last"]
    envelope, start = envelope_of(case), initial_coordinates(case)
    margins = [
        envelope.margins(passage(case, start, n).end[None])[0] for n in (settled - 1, settled)
    ]
    assert margins[0] <= 0.0 < margins[1]
    events = passage(case, start, settled + 300).events
    lost = events[events[:, REGIME] != 1, TIME]
    assert 0.0 < lost.max() < settled * case.period
    # The bearings damp what is left; -1/ln|mu| periods is its time constant.
    orbit = find_orbit(case)
    assert attractor.time_constant == pytest.approx(-1.0 / np.log(abs(orbit.multipliers[0])))


def test_motion_that_still_moves_has_the_time_constant_of_the_bearings(found):
    attractor, settled, _ = found["for ever shallower"]
    assert settled is None
    slowest = abs(find_orbit(CASES["for ever shallower"]).multipliers[0])
    assert attractor.time_constant == pytest.approx(-1.0 / np.log(slowest), rel=1e-6)


def test_cases_do_not_depend_on_each_other(found):
    for name, one in zip(list(CASES)[::-1], classify(list(CASES.values())[::-1]), strict=True):
        assert one.attractor.label == found[name].attractor.label
        assert one.settled == found[name].settled


def test_a_run_that_is_in_contact_from_the_start_waits_for_no_other(found):
    """Its last loss of contact is searched for together with that of runs that take longer."""
    losing = CASES["in contact at last"]
    contact = replace(losing, initial_state=State(*linear_orbit(losing).tolist()))
    (alone,), both = classify([contact]), classify([contact, losing])
    assert alone.settled == both[0].settled == 0
    assert both[1].settled == found["in contact at last"].settled > 0
