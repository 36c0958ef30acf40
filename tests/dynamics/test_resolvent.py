"""Orbits by shooting against Green's resolvent, which takes no steps in time."""

import numpy as np
import pytest
from problems import problem
from resolvent import AT_END, Piece, solve, times_of

from gearmesh.dynamics.periodic.orbits import find_orbit
from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH, regime_of
from gearmesh.model.segments import segments
from gearmesh.solvers.reduced.derivatives.variational import (
    AFTER,
    CROSSING,
    HEIGHT,
    KIND,
    REGIME,
    SWITCH,
    TIME,
    TURN,
    VELOCITY,
)

HEAVY = {"body_mass": 1000.0}
TIGHT = {"body_mass": 1000.0, "backlash": 1.0}

CASES = [
    ("c-material", 0.62, 1, HEAVY, (1,)),
    ("a-conservative", 1.15, 1, HEAVY, (1,)),
    ("b-both", 0.9, 1, {}, (1, 0)),
    ("d-lubricant", 0.81, 1, HEAVY, (1, 0)),
    ("h-lubricant", 1.0, 1, {"friction_coefficient": 0.0}, (1, 0)),
    ("c-lubricant", 0.66, 2, HEAVY, (1, 0, 1, 0)),
    ("c-lubricant", 0.61, 2, HEAVY, (1, 0, 1, 0, 1, 0)),
    ("b-lubricant", 0.9, 1, TIGHT, (1, 0, -1, 0)),
]
"""One regime to six, all powers of y', and contact with one flank and with both."""


def pieces_of(orbit):
    """Return the pieces of an orbit's period and their ends."""
    case, events = orbit.problem, orbit.passage.events
    friction = case.friction_coefficient * np.tan(case.pressure_angle)
    boundaries = [
        (n + part.start) * case.period for n in range(orbit.periods) for part in segments(case)
    ]
    laws = [
        (case.stiffness_max if part.double else case.stiffness_min, friction * part.gamma)
        for _ in range(orbit.periods)
        for part in segments(case)
    ]
    marks = [(time, "segment", laws[i]) for i, time in enumerate(boundaries)]
    marks += [(event[TIME], "event", event) for event in events if event[KIND] != SWITCH]
    regime = regime_of(orbit.y, case.backlash)
    sign, law, pieces, ends = np.sign(orbit.v), None, [], []
    marks.sort(key=lambda mark: mark[:2])
    for i, (_, what, data) in enumerate(marks):
        if what == "segment":
            law = data
        elif data[KIND] == CROSSING:
            regime = int(data[REGIME])
        elif data[KIND] == TURN:
            sign = np.sign(data[AFTER])
        end, following, event = marks[i + 1] if i + 1 < len(marks) else (None, "segment", None)
        finish = None
        if following == "event" and event[KIND] == TURN:
            finish = ("v", 0.0)
        elif following == "event":
            finish = ("y", 0.0 if NORMAL_MESH in (regime, event[REGIME]) else -case.backlash)
        touching = regime != CONTACT_LOSS
        level = -case.backlash if regime == INVERSE_MESH else 0.0
        damping = case.material if touching else case.lubricant
        stiffness = law[0] if touching else 0.0
        pieces.append(Piece(stiffness, law[1], level, damping, sign, finish))
        ends.append(orbit.periods * case.period if end is None else end)
    return pieces, np.array(ends)


@pytest.mark.parametrize(("name", "nu", "periods", "changes", "signature"), CASES)
def test_the_resolvent_gives_the_same_orbit(name, nu, periods, changes, signature):
    orbit = find_orbit(problem(nu, name, **changes), periods)
    assert orbit.signature == signature
    pieces, ends = pieces_of(orbit)
    # The guess is off in y and y' and in the times of the events.
    moving = np.array([piece.event is not None for piece in pieces])
    rough = ends + np.where(moving, 2e-4 * orbit.problem.period * np.cos(np.arange(len(ends))), 0.0)
    course = orbit.time_course(512)
    times = times_of(rough)
    y = np.interp(times, course.time, course.y, period=orbit.periods * orbit.problem.period)
    v = np.interp(times, course.time, course.v, period=orbit.periods * orbit.problem.period)
    y, v = y + 0.002 * np.cos(times), v - 0.002 * np.sin(times)
    found, y, v = solve(orbit.problem, periods, pieces, rough, y, v)
    np.testing.assert_allclose(found, ends, atol=1e-8, rtol=0)
    after = orbit.passage.events[orbit.passage.events[:, TIME] > 0.0]
    for i, end in enumerate(ends[:-1]):
        event = after[np.argmin(np.abs(after[:, TIME] - end))]
        if event[TIME] == pytest.approx(end, abs=1e-12):
            assert AT_END @ y[i] == pytest.approx(event[HEIGHT], abs=1e-8)
            assert AT_END @ v[i] == pytest.approx(event[VELOCITY], abs=1e-8)
    assert [AT_END @ y[-1], AT_END @ v[-1]] == pytest.approx([orbit.y, orbit.v], abs=1e-8)
