"""The stroboscopic maps of many problems with heyoka in batches.

The equations, events and saltation matrices are those of `heyoka_map`. As in
`benchmarks.peers.heyoka_batch`, all lanes stop at a switch together, so only contact and turning
points are events of a lane. Numba compiles what the callbacks do.
"""

from collections.abc import Sequence
from functools import lru_cache

import heyoka as hy
import numpy as np
from numba import njit

from benchmarks.orbits.heyoka_map import TOLERANCE
from benchmarks.peers.heyoka_system import (
    BACKLASH,
    CUBIC,
    LINEAR,
    OFFSET,
    QUADRATIC,
    SHARE,
    STIFFNESS,
    SUPPORT,
    SWITCH,
    W,
    Y,
    equations,
    scaled,
)
from benchmarks.reduced import Terms, pieces_of, terms
from gearmesh.model.problem import Problem

LANES = 2 * hy.recommended_simd_size()
"""Twice as many as heyoka recommends are fastest, because each call from Python costs time."""

_REGIMES = (0, 1, -1)  # the last one is also where an array has its index -1
_IDENTITY = np.eye(4).reshape(16, 1)


class Stroboscopes:
    """The maps of problems with the same damping terms and the same phases of the switches."""

    def __init__(self, problems: Sequence[Problem]):
        cut = pieces_of(problems[0])
        runs = [scaled(problem, cut) for problem in problems]
        self.integrator = _integrator(terms(problems[0]))
        self.ends = [piece.end for piece in cut]
        self.stiffness = np.array([run.stiffness for run in runs])
        self.share = np.array([run.share for run in runs])
        self.damping = np.array([[run.damping[at] for at in _REGIMES] for run in runs])
        self.fixed = np.array([[run.fixed.get(at, 0.0) for at in range(SWITCH)] for run in runs])
        self.scale = np.array([[1.0, run.period, 1.0, run.period] for run in runs])

    def __call__(self, which: np.ndarray, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states one mesh period later, and the Jacobians, in 1/Omega_s.

        Parameters
        ----------
        which : ndarray of int, shape (n,)
            Numbers of the problems. Copies of the last one fill the last batch.
        states : ndarray, shape (n, 4)

        Returns
        -------
        tuple of ndarray
            Shapes (n, 4) and (n, 4, 4).
        """
        n, scale = len(which), self.scale[which]
        lanes = np.pad(np.arange(n), (0, -n % LANES), mode="edge").reshape(-1, LANES)
        of_problems = (self.fixed, self.damping, self.stiffness, self.share)
        parts = (states * scale, *(part[which] for part in of_problems))
        batches = zip(*(np.moveaxis(part[lanes], 1, -1) for part in parts), strict=True)
        moved = np.concatenate([self._moved(*batch).T for batch in batches])[:n]
        jacobians = moved[:, 4:].reshape(n, 4, 4) * scale[:, None] / scale[:, :, None]
        return moved[:, :4] / scale, jacobians

    def _moved(self, states, fixed, damping, stiffness, share) -> np.ndarray:
        """Move one batch; the lanes are the last axis of all arrays."""
        self.integrator.start(states, fixed, damping)
        for end, *now in zip(self.ends, stiffness, share, strict=True):
            self.integrator.propagate(end, *now)
        return self.integrator.state.copy()


@lru_cache
def _integrator(acting: Terms) -> "_Integrator":
    return _Integrator(acting)


class _Integrator:
    """The compiled integrator of a set of damping terms, and what its callbacks share."""

    def __init__(self, acting: Terms):
        events = [
            hy.t_event_batch(Y, callback=self._cross_zero),
            hy.t_event_batch(Y + hy.par[BACKLASH], callback=self._cross_back),
        ]
        if acting.quadratic:
            events.append(hy.t_event_batch(W, callback=self._turn))
        self.adaptive = hy.taylor_adaptive_batch(
            hy.var_ode_sys(equations(acting), hy.var_args.vars),
            np.zeros((4, LANES)),
            tol=TOLERANCE,
            fast_math=True,
            t_events=events,
        )
        self.state, self.pars = self.adaptive.state, self.adaptive.pars
        self.regime, self.sign = np.zeros(LANES, np.int64), np.zeros(LANES)
        self.stiffness, self.damping = np.zeros(LANES), np.zeros((len(_REGIMES), 3, LANES))

    def __deepcopy__(self, memo):
        """Stay one object: heyoka copies the callbacks of its events, and this with them."""
        return self

    def start(self, states: np.ndarray, fixed: np.ndarray, damping: np.ndarray) -> None:
        """Set the lanes to the beginning of a mesh period."""
        self.adaptive.set_time(0.0)
        self.adaptive.reset_cooldowns()
        self.state[:4], self.state[4:] = states, _IDENTITY
        self.pars[:], self.damping[:] = fixed, damping
        y, w = states[:2]
        self.regime[:] = np.where(y >= 0.0, 1, np.where(y <= -fixed[BACKLASH], -1, 0))
        self.sign[:] = np.where(w > 0.0, 1.0, -1.0)

    def propagate(self, end: float, stiffness: np.ndarray, share: np.ndarray) -> None:
        """Move all lanes to the end of a piece of the mesh period."""
        self.stiffness[:], self.pars[SHARE] = stiffness, share
        _enter_regimes(self.pars, self.regime, self.sign, self.stiffness, self.damping)
        self.adaptive.propagate_until(end)

    def _cross_zero(self, integrator, direction, lane):
        return self._cross(lane, 1 if direction > 0 else 0)

    def _cross_back(self, integrator, direction, lane):
        return self._cross(lane, 0 if direction > 0 else -1)

    def _cross(self, lane, following):
        constants = self.pars, self.regime, self.sign, self.stiffness, self.damping
        _jump(self.state, *constants, lane, following)
        return True

    def _turn(self, integrator, direction, lane):
        self.sign[lane] = direction
        self.pars[QUADRATIC, lane] = direction * self.damping[self.regime[lane], 1, lane]
        return True


@njit
def _enter_regimes(pars, regime, sign, stiffness, damping):
    for lane in range(LANES):
        _enter_regime(pars, regime, sign, stiffness, damping, lane)


@njit
def _enter_regime(pars, regime, sign, stiffness, damping, lane):
    at = regime[lane]
    pars[STIFFNESS, lane] = stiffness[lane] if at != 0 else 0.0
    pars[OFFSET, lane] = -pars[BACKLASH, lane] if at < 0 else 0.0
    pars[LINEAR, lane] = damping[at, 0, lane]
    pars[QUADRATIC, lane] = sign[lane] * damping[at, 1, lane]
    pars[CUBIC, lane] = damping[at, 2, lane]


@njit
def _jump(state, pars, regime, sign, stiffness, damping, lane, following):
    """Jump to the other regime; the elastic force is 0 on both sides, damping is not."""
    w = state[1, lane]
    k1, k2, k3 = damping[following, :, lane] - damping[regime[lane], :, lane]
    jump = k1 + k2 * abs(w) + k3 * w * w  # of the force, divided by w
    body = -pars[SUPPORT, lane] * jump
    for j in range(4):
        height = state[4 + j, lane]
        state[8 + j, lane] += (body - jump) * height
        state[16 + j, lane] += body * height
    regime[lane] = following
    _enter_regime(pars, regime, sign, stiffness, damping, lane)
