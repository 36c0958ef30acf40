"""heyoka in batches: as many runs side by side as the machine's vectors hold.

With time in mesh periods all lanes reach a switch together, so the batch stops there and Python
sets the parameters of all lanes in one go; only contact and turning points are events of a lane.
`propagate_grid` would spend more on the dense samples than on the motion, so the kept steps'
Taylor series are stored by a step callback, and a compiled loop evaluates them.
"""

from collections.abc import Sequence
from functools import lru_cache

import heyoka as hy
import numpy as np
from numba import njit

from benchmarks.outcome import SAMPLES_PER_PERIOD, Outcome
from benchmarks.peers.heyoka_system import (
    BACKLASH,
    LINEAR,
    OFFSET,
    QUADRATIC,
    SHARE,
    STIFFNESS,
    W,
    Y,
    equations,
    scaled,
)
from benchmarks.reduced import Piece, Terms, initial_state, periods, pieces_of, terms
from gearmesh.model.problem import Problem

LANES = hy.recommended_simd_size()


def solve(problems: Sequence[Problem], tolerance: float) -> list[Outcome]:
    """Solve runs of one variant, `LANES` at a time; the last batch is filled with copies."""
    outcomes = []
    for first in range(0, len(problems), LANES):
        batch = list(problems[first : first + LANES])
        n_runs = len(batch)
        batch += batch[-1:] * (LANES - n_runs)
        outcomes += integrator(terms(batch[0]), tolerance).solve(batch)[:n_runs]
    return outcomes


@lru_cache
def integrator(terms: Terms, tolerance: float) -> "Integrator":
    """Return the integrator of a set of damping terms, compiled once."""
    return Integrator(terms, tolerance)


class Integrator:
    """The two compiled integrators of a set of damping terms, and what their callbacks share."""

    def __init__(self, terms: Terms, tolerance: float):
        self.terms = terms
        contact = [
            hy.t_event_batch(Y, callback=self._cross_zero),
            hy.t_event_batch(Y + hy.par[BACKLASH], callback=self._cross_back),
        ]

        def build(terminal, passing):
            return hy.taylor_adaptive_batch(
                equations(terms),
                np.zeros((4, LANES)),
                tol=tolerance,
                fast_math=True,
                t_events=terminal,
                nt_events=passing,
            )

        if terms.quadratic:
            turning = hy.t_event_batch(W, callback=self._turn)
            self.early = self.late = build([*contact, turning], [])
        else:
            self.early = build(contact, [])
            self.late = build(contact, [hy.nt_event_batch(W, callback=self._pass_extremum)])

    def __deepcopy__(self, memo):
        """Stay one object: heyoka copies the callbacks of its events, and this with them."""
        return self

    def solve(self, problems: Sequence[Problem]) -> list[Outcome]:
        """Integrate one batch and collect its outputs."""
        total, first_kept = periods(problems[0])
        cut = pieces_of(problems[0])
        self.prepare(problems, cut, [initial_state(p) for p in problems])
        strobes = [self.state[:2].copy()]
        for n in range(first_kept):
            self.propagate_period(n, cut, self.active.propagate_until)
            strobes.append(self.state[:2].copy())

        self.keep = True
        if self.late is not self.early:
            self._hand_over(first_kept)

        def propagate_storing(time):
            self.active.propagate_until(time, write_tc=True, callback=self._store_step)

        for n in range(first_kept, total):
            self.propagate_period(n, cut, propagate_storing)
            strobes.append(self.state[:2].copy())
        return self._outcomes(np.array(strobes), first_kept, total)

    def prepare(self, problems, cut: tuple[Piece, ...], states):
        """Set the lanes to `states`, each (y, w, Y, dY/dt) with time in mesh periods."""
        if any([(q.start, q.end) for q in pieces_of(p)] != [(q.start, q.end) for q in cut]
               for p in problems):  # fmt: skip
            raise ValueError("the runs of a batch must switch at the same phases")
        runs = [scaled(p, pieces_of(p)) for p in problems]
        self.period = np.array([run.period for run in runs])
        self.damping = [run.damping for run in runs]
        self.backlash = [p.backlash for p in problems]
        self.piece_stiffness = np.array([run.stiffness for run in runs]).T
        self.piece_share = np.array([run.share for run in runs]).T
        self._use(self.early)
        self.early.set_time(0.0)
        self.early.reset_cooldowns()
        self.state[:] = np.transpose(states)
        for place in runs[0].fixed:
            self.pars[place] = [run.fixed[place] for run in runs]

        self.keep = False
        self.extrema = []
        self.steps = []
        self.regime = [
            1 if y >= 0 else (-1 if y <= -back else 0)
            for y, back in zip(self.state[0], self.backlash, strict=True)
        ]
        # At rest, y turns towards its acceleration: C differs from C_s, under which it rests.
        rest = 1.0 if cut[0].stiffness < 1 else -1.0
        self.sign = [float(np.sign(w)) or rest for w in self.state[1]]
        self.stiffness = self.piece_stiffness[0].tolist()
        for lane in range(LANES):
            self._enter_regime(lane)

    def _use(self, integrator):
        self.active, self.pars, self.state = integrator, integrator.pars, integrator.state
        self.time, self.series, self.last_step = integrator.time, integrator.tc, integrator.last_h

    def _hand_over(self, time):
        self.late.set_time(time)
        self.late.state[:] = self.state
        self.late.pars[:] = self.pars
        self.late.reset_cooldowns()
        self._use(self.late)

    def propagate_period(self, n, cut, propagate):
        """Move all lanes over the mesh period `n`, with a function that moves to a time."""
        for piece, stiffness, share in zip(
            cut, self.piece_stiffness, self.piece_share, strict=True
        ):
            self.stiffness = stiffness.tolist()
            self.pars[SHARE] = share
            self.pars[STIFFNESS] = (
                stiffness if all(self.regime) else np.where(self.regime, stiffness, 0.0)
            )
            propagate(n + piece.end)

    def _enter_regime(self, lane):
        regime, pars = self.regime[lane], self.pars
        pars[STIFFNESS, lane] = self.stiffness[lane] if regime else 0.0
        pars[OFFSET, lane] = -self.backlash[lane] if regime < 0 else 0.0
        coefficients = self.damping[lane][regime]
        if self.terms.linear:
            pars[LINEAR, lane] = coefficients[0]
        if self.terms.quadratic:
            pars[QUADRATIC, lane] = self.sign[lane] * coefficients[1]
        if self.terms.cubic:
            pars[LINEAR + 2, lane] = coefficients[2]

    def _cross_zero(self, integrator, direction, lane):
        self.regime[lane] = 1 if direction > 0 else 0
        self._enter_regime(lane)
        return True

    def _cross_back(self, integrator, direction, lane):
        self.regime[lane] = 0 if direction > 0 else -1
        self._enter_regime(lane)
        return True

    def _turn(self, integrator, direction, lane):
        self.sign[lane] = direction
        self.pars[QUADRATIC, lane] = direction * self.damping[lane][self.regime[lane]][1]
        if self.keep:
            # A terminal event ends its step, so the step's series reaches just up to it.
            self.extrema.append((len(self.steps), lane, self.time[lane]))
        return True

    def _pass_extremum(self, integrator, time, direction, lane):
        self.extrema.append((len(self.steps), lane, time))

    def _store_step(self, integrator):
        self.steps.append((self.time.copy(), self.last_step.copy(), self.series[:2].copy()))
        return True

    def _outcomes(self, strobes, first_kept, total):
        ends, lengths, series = (np.array(part) for part in zip(*self.steps, strict=True))
        starts = ends - lengths
        samples = np.empty((LANES, 2, (total - first_kept) * SAMPLES_PER_PERIOD))
        _sample(series, starts, ends, float(first_kept), samples)
        steps, lanes, times = (np.array(part) for part in zip(*self.extrema, strict=True))
        extrema = _evaluate(series, starts, steps, lanes, times)
        return [
            Outcome(
                extremum_y=extrema[lanes == lane],
                strobe_y=strobes[:, 0, lane],
                strobe_v=strobes[:, 1, lane] / self.period[lane],
                sample_y=samples[lane, 0],
                sample_v=samples[lane, 1] / self.period[lane],
            )
            for lane in range(LANES)
        ]


@njit(fastmath=True)
def _sample(series, starts, ends, first, samples):
    """Evaluate the steps' Taylor series at the sample times into `samples` (lane, y and w, i)."""
    n_steps, _, n_terms, n_lanes = series.shape
    n_samples = samples.shape[2]
    for lane in range(n_lanes):
        i = 0
        for step in range(n_steps):
            while i < n_samples:
                time = first + i / SAMPLES_PER_PERIOD
                if time > ends[step, lane]:
                    break
                offset = time - starts[step, lane]
                y = w = 0.0
                for k in range(n_terms - 1, -1, -1):
                    y = y * offset + series[step, 0, k, lane]
                    w = w * offset + series[step, 1, k, lane]
                samples[lane, 0, i] = y
                samples[lane, 1, i] = w
                i += 1


@njit(fastmath=True)
def _evaluate(series, starts, steps, lanes, times):
    """Evaluate y at `times`, each in its step and lane."""
    y = np.zeros(len(times))
    for i in range(len(times)):
        offset = times[i] - starts[steps[i], lanes[i]]
        for k in range(series.shape[2] - 1, -1, -1):
            y[i] = y[i] * offset + series[steps[i], 0, k, lanes[i]]
    return y
