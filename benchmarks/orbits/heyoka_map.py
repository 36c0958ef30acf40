"""The stroboscopic map and its Jacobian with heyoka: variational equations and events.

The set-up is that of `benchmarks.peers.heyoka_scalar`: one call a period, with events for the
switches, for contact and for the turning points that |v| v needs. heyoka derives the variational
equations. It does not know that damping jumps at a contact event, so the callback multiplies the
Jacobian by the saltation matrix.
"""

from functools import lru_cache

import heyoka as hy
import numpy as np

from benchmarks.peers.heyoka_system import (
    BACKLASH,
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

TOLERANCE = 1e-12
_IDENTITY = np.eye(4).ravel()


class Stroboscope:
    """The map of one problem; a compiled integrator is shared by all with the same damping."""

    def __init__(self, problem: Problem):
        self.integrator = _integrator(terms(problem))
        self.problem = problem
        self.constants = scaled(problem, pieces_of(problem))
        self.scale = np.array([1.0, problem.period, 1.0, problem.period])

    def __call__(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the state one mesh period later and the Jacobian, in 1/Omega_s."""
        end = self.integrator.propagate(self.problem, self.constants, state * self.scale)
        jacobian = end[4:].reshape(4, 4) * self.scale / self.scale[:, None]
        return end[:4] / self.scale, jacobian


@lru_cache
def _integrator(acting: Terms) -> "_Integrator":
    return _Integrator(acting)


class _Integrator:
    def __init__(self, acting: Terms):
        self.terms = acting
        events = [
            hy.t_event(hy.time - hy.par[SWITCH], callback=self._switch),
            hy.t_event(Y, callback=self._cross_zero),
            hy.t_event(Y + hy.par[BACKLASH], callback=self._cross_back),
        ]
        if acting.quadratic:
            events.append(hy.t_event(W, callback=self._turn))
        self.adaptive = hy.taylor_adaptive(
            hy.var_ode_sys(equations(acting), hy.var_args.vars),
            np.zeros(4),
            tol=TOLERANCE,
            fast_math=True,
            compact_mode=False,
            t_events=events,
        )
        self.pars, self.state = self.adaptive.pars, self.adaptive.state

    def __deepcopy__(self, memo):
        """Stay one object: heyoka copies the callbacks of its events, and this with them."""
        return self

    def propagate(self, problem: Problem, constants, start: np.ndarray) -> np.ndarray:
        self.damping = constants.damping
        self.backlash = problem.backlash
        for place, value in constants.fixed.items():
            self.pars[place] = value
        per_piece = list(zip(constants.stiffness, constants.share, strict=True))
        self.switches = [
            (piece.start, *now)
            for piece, last, now in zip(
                pieces_of(problem)[1:], per_piece, per_piece[1:], strict=False
            )
            if now != last
        ]
        self.next_switch = 0
        self.stiffness, self.pars[SHARE] = per_piece[0]
        self._await_switch()
        y, w = start[0], start[1]
        self.regime = 1 if y >= 0 else (-1 if y <= -self.backlash else 0)
        self.sign = 1.0 if w > 0 else -1.0
        self._enter_regime()
        self.adaptive.time = 0.0
        self.adaptive.reset_cooldowns()
        self.state[:4], self.state[4:] = start, _IDENTITY
        self.adaptive.propagate_until(1.0)
        return self.state.copy()

    def _await_switch(self):
        done = self.next_switch == len(self.switches)
        self.pars[SWITCH] = 2.0 if done else self.switches[self.next_switch][0]

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
        coefficients = self.damping[regime]
        if self.terms.linear:
            pars[LINEAR] = coefficients[0]
        if self.terms.quadratic:
            pars[QUADRATIC] = self.sign * coefficients[1]
        if self.terms.cubic:
            pars[LINEAR + 2] = coefficients[2]

    def _cross_zero(self, integrator, direction):
        return self._cross(1 if direction > 0 else 0)

    def _cross_back(self, integrator, direction):
        return self._cross(0 if direction > 0 else -1)

    def _cross(self, following):
        """Jump to the other regime; the elastic force is 0 on both sides, damping is not."""
        before, after = self.damping[self.regime], self.damping[following]
        w = self.state[1]
        k1, k2, k3 = (b - a for a, b in zip(before, after, strict=True))
        jump = k1 + k2 * abs(w) + k3 * w * w  # of the force, divided by w
        body = -self.pars[SUPPORT] * jump
        height = self.state[4:8].copy()
        self.state[8:12] += (body - jump) * height
        self.state[16:20] += body * height
        self.regime = following
        self._enter_regime()
        return True

    def _turn(self, integrator, direction):
        self.sign = direction
        self.pars[QUADRATIC] = direction * self.damping[self.regime][1]
        return True
