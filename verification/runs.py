"""The runs, integrated by heyoka: Taylor series at the tolerance of rounding, events located by it.

As many runs as a vector holds go side by side. Time is in mesh periods, so all runs of a batch
meet their stiffness switches together, and the batch stops there. Contact and turning points are
terminal events of each run: the step ends at the event, and the callback changes what acts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import heyoka as hy
import numpy as np

from verification.statement import Piece, Run

LANES = hy.recommended_simd_size()
TOLERANCE = 1e-16
SAMPLES_PER_PERIOD = 256
NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH = 1, 0, -1

PARAMETERS = (
    *("load", "stiffness", "level", "friction", "linear", "quadratic", "cubic"),
    *("two_over_mass", "bearing_damping", "bearing", "backlash"),
)
PLACE = {name: place for place, name in enumerate(PARAMETERS)}


@dataclass
class Outcome:
    """What a run gives, in y_st and mesh periods.

    Attributes
    ----------
    strobes : ndarray, shape (n_periods + 1, 2)
        y and y' at the boundaries of the mesh periods.
    extrema : list of (time, y, kind)
        Turning points of y in the last revolution; kind is 1 for a maximum and -1 for a minimum.
    losses : int
        Contact losses in the last revolution.
    shares : dict of int to float
        Share of the last revolution in contact loss and in inverse mesh.
    mean_square : float
        Mean of y² over the last revolution.
    samples : ndarray, shape (n, 4), or None
        y, y', Y and Y' at `SAMPLES_PER_PERIOD` equal steps of each period of the last revolution.
    """

    strobes: np.ndarray
    extrema: list[tuple[float, float, int]] = field(default_factory=list)
    losses: int = 0
    shares: dict[int, float] = field(default_factory=dict)
    mean_square: float = 0.0
    samples: np.ndarray | None = None


def solve(runs: Sequence[Run], displacement: float = 0.0, samples: bool = False) -> list[Outcome]:
    """Integrate runs of one study; y starts `displacement` away from rest."""
    integrator = _batch()
    outcomes: list[Outcome] = []
    for first in range(0, len(runs), LANES):
        batch = list(runs[first : first + LANES])
        full = batch + batch[-1:] * (LANES - len(batch))
        outcomes += integrator.solve(full, displacement, samples)[: len(batch)]
    return outcomes


def acceleration(
    run: Run, piece: np.ndarray, regime: np.ndarray, state: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Return y'' by the same equations, at states (y, y', Y, Y') in the given pieces."""
    y, w, body, body_rate = state
    stiffness = np.array([part.stiffness for part in run.pieces])[piece]
    gamma = np.array([part.gamma for part in run.pieces])[piece]
    depth = np.where(regime == INVERSE_MESH, y + run.backlash, y) * (regime != CONTACT_LOSS)
    normal = elastic = stiffness * depth
    touching = regime != CONTACT_LOSS
    for power, (contact, loss) in enumerate(zip(run.contact, run.loss, strict=True)):
        normal = normal + np.where(touching, contact, loss) * np.abs(w) ** power * w
    pull = -2.0 / run.mass * normal - run.bearing_damping * body_rate - run.bearing * body
    return run.load - normal + run.friction * gamma * elastic + pull


def _equations() -> list[tuple[Any, Any]]:
    """Return the equations of `verification.statement`; |y'| y' has the sign in its coefficient."""
    y, w, body, body_rate = hy.make_vars("y", "w", "b", "b_rate")
    p = {name: hy.par[place] for name, place in PLACE.items()}
    elastic = p["stiffness"] * (y - p["level"])
    normal = elastic + p["linear"] * w + p["quadratic"] * (w * w) + p["cubic"] * (w * w * w)
    pull = -p["two_over_mass"] * normal - p["bearing_damping"] * body_rate - p["bearing"] * body
    return [
        (y, w),
        (w, p["load"] - normal + p["friction"] * elastic + pull),
        (body, body_rate),
        (body_rate, pull),
        (hy.make_vars("square"), y * y),
    ]


@cache
def _batch() -> "_Batch":
    return _Batch()


class _Batch:
    """The compiled integrator, and what its callbacks share."""

    def __init__(self) -> None:
        y, w = hy.make_vars("y", "w")
        self.integrator = hy.taylor_adaptive_batch(
            _equations(),
            np.zeros((5, LANES)),
            tol=TOLERANCE,
            t_events=[
                hy.t_event_batch(y, callback=self._cross_front),
                hy.t_event_batch(y + hy.par[PLACE["backlash"]], callback=self._cross_back),
                hy.t_event_batch(w, callback=self._turn),
            ],
        )
        self.pars, self.state = self.integrator.pars, self.integrator.state

    def __deepcopy__(self, memo: object) -> "_Batch":
        """Stay one object: heyoka copies callbacks, and this with them."""
        return self

    def solve(self, runs: Sequence[Run], displacement: float, samples: bool) -> list[Outcome]:
        """Integrate one batch."""
        self._start(runs, displacement)
        strobes = [self.state[:2].copy()]
        square = np.zeros(LANES)
        sampled: list[np.ndarray] = []
        kept_from = runs[0].periods - runs[0].teeth
        for period in range(runs[0].periods):
            if period == kept_from:
                self._keep(period)
            self.state[4] = 0.0
            for index, piece in enumerate(runs[0].pieces):
                self._switch(index)
                self._advance(period, piece, sampled if samples and self.kept else None)
            strobes.append(self.state[:2].copy())
            square += self.state[4] * self.kept
        self._leave(float(runs[0].periods))
        rows = np.array(strobes)
        for lane, outcome in enumerate(self.outcomes):
            outcome.strobes = rows[:, :, lane]
            outcome.mean_square = float(square[lane] / runs[lane].teeth)
            if samples:
                outcome.samples = np.concatenate([part[:, :4, lane] for part in sampled])
        return self.outcomes

    def _start(self, runs: Sequence[Run], displacement: float) -> None:
        if any(
            [(piece.start, piece.end) for piece in run.pieces]
            != [(piece.start, piece.end) for piece in runs[0].pieces]
            for run in runs
        ):
            raise ValueError("the runs of a batch must switch at the same phases")
        self.runs = runs
        self.kept = False
        self.piece = 0
        self.outcomes = [Outcome(np.empty(0)) for _ in runs]
        self.regime = [NORMAL_MESH] * LANES
        self.integrator.set_time(0.0)
        self.integrator.reset_cooldowns()
        for lane, run in enumerate(runs):
            self.state[:, lane] = 1.0 + displacement, 0.0, run.rest, 0.0, 0.0
            self._set(lane, "load", run.load)
            self._set(lane, "two_over_mass", 2.0 / run.mass)
            self._set(lane, "bearing_damping", run.bearing_damping)
            self._set(lane, "bearing", run.bearing)
            self._set(lane, "backlash", run.backlash)
        self.sign = [self._first_direction(run) for run in runs]
        pieces = range(len(runs[0].pieces))
        self.stiffness = np.array([[run.pieces[i].stiffness for run in runs] for i in pieces])
        self.friction = np.array(
            [[run.friction * run.pieces[i].gamma for run in runs] for i in pieces]
        )
        for lane in range(LANES):
            self._enter(lane)

    def _first_direction(self, run: Run) -> int:
        """Return where y moves from rest: the bearings pull as before, the stiffness is another."""
        piece = run.pieces[0]
        excess = run.load - piece.stiffness
        pulled = excess + run.friction * piece.gamma * piece.stiffness + 2.0 / run.mass * excess
        return 1 if pulled > 0.0 else -1

    def _keep(self, period: int) -> None:
        self.kept = True
        self.since = [float(period)] * LANES
        for outcome in self.outcomes:
            outcome.shares = {NORMAL_MESH: 0.0, CONTACT_LOSS: 0.0, INVERSE_MESH: 0.0}

    def _advance(self, period: int, piece: Piece, sampled: list[np.ndarray] | None) -> None:
        start, end = piece.start, piece.end
        if sampled is None:
            self.integrator.propagate_until(period + end)
            return
        first, last = (int(np.ceil(place * SAMPLES_PER_PERIOD)) for place in (start, end))
        times = period + np.arange(first, last) / SAMPLES_PER_PERIOD
        aside = int(times[0] > period + start)  # heyoka wants the present time in front
        grid = np.concatenate([[period + start] * aside, times, [period + end]])
        _, states = self.integrator.propagate_grid(np.repeat(grid[:, None], LANES, axis=1))
        sampled.append(states[aside:-1].copy())

    def _set(self, lane: int, name: str, value: float) -> None:
        self.pars[PLACE[name], lane] = value

    def _switch(self, piece: int) -> None:
        """Set what acts in a piece of the mesh period in all lanes."""
        self.piece = piece
        touching = np.array(self.regime) != CONTACT_LOSS
        self.pars[PLACE["stiffness"]] = self.stiffness[piece] * touching
        self.pars[PLACE["friction"]] = self.friction[piece]

    def _enter(self, lane: int) -> None:
        """Set what acts in the regime and the direction of motion of a lane."""
        run, regime = self.runs[lane], self.regime[lane]
        linear, quadratic, cubic = run.contact if regime != CONTACT_LOSS else run.loss
        stiffness = self.stiffness[self.piece, lane]
        self._set(lane, "stiffness", stiffness if regime != CONTACT_LOSS else 0.0)
        self._set(lane, "level", -run.backlash if regime == INVERSE_MESH else 0.0)
        self._set(lane, "linear", linear)
        self._set(lane, "quadratic", quadratic * self.sign[lane])
        self._set(lane, "cubic", cubic)

    def _change(self, lane: int, regime: int) -> bool:
        if self.kept:
            self._spend(lane, float(self.integrator.time[lane]))
            self.outcomes[lane].losses += regime == CONTACT_LOSS
        self.regime[lane] = regime
        self._enter(lane)
        return True

    def _spend(self, lane: int, now: float) -> None:
        teeth = self.runs[lane].teeth
        self.outcomes[lane].shares[self.regime[lane]] += (now - self.since[lane]) / teeth
        self.since[lane] = now

    def _leave(self, now: float) -> None:
        for lane in range(LANES):
            self._spend(lane, now)

    def _cross_front(self, integrator: object, direction: int, lane: int) -> bool:
        return self._change(lane, NORMAL_MESH if direction > 0 else CONTACT_LOSS)

    def _cross_back(self, integrator: object, direction: int, lane: int) -> bool:
        return self._change(lane, CONTACT_LOSS if direction > 0 else INVERSE_MESH)

    def _turn(self, integrator: object, direction: int, lane: int) -> bool:
        """Note a turning point: `direction` is the sign of y' after it."""
        self.sign[lane] = direction
        self._enter(lane)
        if self.kept:
            time, y = float(self.integrator.time[lane]), float(self.state[0, lane])
            self.outcomes[lane].extrema.append((time, y, -direction))
        return True
