"""heyoka, one run at a time.

One `propagate_grid` call covers all early periods and one the kept ones: every call from Python
costs as much as several steps, so switches are events in time, contact and (for |v| v) turning
points are terminal events whose callbacks set the parameters and let the integration go on.
Without |v| v turning points matter in the kept periods only: a second integrator that watches
them takes over there.
"""

from collections.abc import Sequence
from functools import lru_cache

import heyoka as hy
import numpy as np

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.peers.heyoka_system import (
    BACKLASH,
    LINEAR,
    OFFSET,
    QUADRATIC,
    SHARE,
    STIFFNESS,
    SWITCH,
    W,
    Y,
    equations,
    scaled,
)
from benchmarks.reduced import Terms, initial_state, periods, pieces_of, terms
from gearmesh.model.problem import Problem


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve the runs one after the other."""
    return [_integrator(terms(p), tolerance, False).solve(p) for p in problems]


def solve_accurately(problem: Problem, displacement: float = 0.0) -> Outcome:
    """Solve to rounding, the initial y shifted by `displacement`: the reference."""
    return _integrator(terms(problem), 1e-16, True).solve(problem, displacement)


@lru_cache
def _integrator(terms: Terms, tolerance: float, accurate: bool) -> "_Integrator":
    return _Integrator(terms, tolerance, accurate)


@lru_cache
def _grids(total: int, first_kept: int) -> tuple[np.ndarray, np.ndarray]:
    early = np.arange(first_kept + 1.0)
    kept = np.arange(first_kept * SAMPLES_PER_PERIOD, total * SAMPLES_PER_PERIOD + 1)
    return early, kept / SAMPLES_PER_PERIOD


class _Integrator:
    """The two compiled integrators of a set of damping terms, and what their callbacks share."""

    def __init__(self, terms: Terms, tolerance: float, accurate: bool):
        self.quadratic = terms.quadratic
        self.regime_slots = _damping_slots(terms)
        contact = [
            hy.t_event(hy.time - hy.par[SWITCH], callback=self._switch),
            hy.t_event(Y, callback=self._cross_zero),
            hy.t_event(Y + hy.par[BACKLASH], callback=self._cross_back),
        ]

        def build(terminal, passing):
            return hy.taylor_adaptive(
                equations(terms),
                np.zeros(4),
                tol=tolerance,
                high_accuracy=accurate,
                fast_math=not accurate,
                t_events=terminal,
                nt_events=passing,
            )

        if terms.quadratic:
            self.early = self.late = build([*contact, hy.t_event(W, callback=self._turn)], [])
        else:
            self.early = build(contact, [])
            self.late = build(contact, [hy.nt_event(W, callback=self._pass_extremum)])

    def __deepcopy__(self, memo):
        """Stay one object: heyoka copies the callbacks of its events, and this with them."""
        return self

    def solve(self, problem: Problem, displacement: float = 0.0) -> Outcome:
        """Integrate one run and collect its outputs."""
        total, first_kept = periods(problem)
        early_grid, kept_grid = _grids(total, first_kept)
        self._prepare(problem, displacement)
        early = self.early.propagate_grid(early_grid)[-1]
        if self.late is not self.early:
            self._hand_over(first_kept)
        kept = self.late.propagate_grid(kept_grid)[-1]

        strobes = np.concatenate([early[:, :2], kept[SAMPLES_PER_PERIOD::SAMPLES_PER_PERIOD, :2]])
        return Outcome(
            extremum_y=np.array([y for t, y in self.extrema if t >= first_kept]),
            strobe_y=strobes[:, 0],
            strobe_v=strobes[:, 1] / self.constants.period,
            sample_y=kept[:-1, 0],
            sample_v=kept[:-1, 1] / self.constants.period,
        )

    def _prepare(self, problem, displacement):
        cut = pieces_of(problem)
        self.constants = scaled(problem, cut)
        self.backlash = problem.backlash
        self._use(self.early)
        self.early.time = 0.0
        self.early.reset_cooldowns()
        y, v, body, body_rate = initial_state(problem)
        self.state[:] = y + displacement, v, body, body_rate
        for place, value in self.constants.fixed.items():
            self.pars[place] = value

        per_piece = list(zip(self.constants.stiffness, self.constants.share, strict=True))
        before = [per_piece[-1], *per_piece]
        self.switches = [
            (piece.start, *now)
            for piece, now, last in zip(cut, per_piece, before, strict=False)
            if now != last
        ]
        self.next_switch = self.whole_periods = 0
        self.stiffness, self.pars[SHARE] = per_piece[0]
        self._await_switch()

        self.extrema = []
        self.regime = 1
        # At rest, y turns towards its acceleration: C differs from C_s, under which it rests.
        self.sign = 1.0 if cut[0].stiffness < 1 else -1.0
        self._enter_regime()

    def _use(self, integrator):
        self.active, self.pars, self.state = integrator, integrator.pars, integrator.state

    def _hand_over(self, time):
        self.late.time = time
        self.late.state[:] = self.state
        self.late.pars[:] = self.pars
        self.late.reset_cooldowns()
        self._use(self.late)

    def _await_switch(self):
        if self.next_switch == len(self.switches):
            self.next_switch = 0
            self.whole_periods += 1
        self.pars[SWITCH] = self.whole_periods + self.switches[self.next_switch][0]

    def _switch(self, integrator, direction):
        _, self.stiffness, self.pars[SHARE] = self.switches[self.next_switch]
        if self.regime:
            self.pars[STIFFNESS] = self.stiffness
        self.next_switch += 1
        self._await_switch()
        return True

    def _enter_regime(self):
        regime, pars = self.regime, self.pars
        pars[STIFFNESS] = self.stiffness if regime else 0.0
        pars[OFFSET] = -self.backlash if regime < 0 else 0.0
        coefficients = self.constants.damping[regime]
        for power, place in self.regime_slots:
            pars[place] = coefficients[power]
        if self.quadratic:
            pars[QUADRATIC] = self.sign * coefficients[1]

    def _cross_zero(self, integrator, direction):
        self.regime = 1 if direction > 0 else 0
        self._enter_regime()
        return True

    def _cross_back(self, integrator, direction):
        self.regime = 0 if direction > 0 else -1
        self._enter_regime()
        return True

    def _turn(self, integrator, direction):
        self.sign = direction
        self.pars[QUADRATIC] = direction * self.constants.damping[self.regime][1]
        self.extrema.append((integrator.time, self.state[0]))
        return True

    def _pass_extremum(self, integrator, time, direction):
        integrator.update_d_output(time)
        self.extrema.append((time, integrator.d_output[0]))


def _damping_slots(terms: Terms) -> list[tuple[int, int]]:
    """Return (power, parameter) of the terms whose parameter changes with the regime alone."""
    return [(p, LINEAR + p) for p, acts in ((0, terms.linear), (2, terms.cubic)) if acts]
