"""Periodic orbits by Green's resolvent, with no time stepping: for checks of the other methods.

With the mean stiffness alone the equations of motion are linear, x' = A x. The orbit of period T
is then x(t) = integral over a period of K(t - s) g(s) ds, where g holds all else and

    K(tau) = exp(A tau) (1 - exp(A T))^-1 for 0 <= tau < T,

continued with period T. The period is cut at the jumps of C(t) and of the friction and at the
events of the orbit, whose times are unknowns. On each piece g is smooth and known at Gauss nodes;
in the piece of t itself the integral splits at s = t.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BarycentricInterpolator

NODES = 24
"""Nodes of a piece: 18 leave errors of 1e-7 in a long contact loss, 24 less than 1e-8."""

_X, _W = np.polynomial.legendre.leggauss(NODES)


def _values_at(places):
    """Return the matrix that takes values at the nodes to those of their polynomial."""
    return np.array(BarycentricInterpolator(_X, np.eye(NODES))(places))


# For each node: Gauss nodes on both sides of it, and the weights of values at the nodes there.
_SIDES = []
for _end in (-1.0, 1.0):
    _places = 0.5 * (_X[:, None] + _end + np.abs(_X[:, None] - _end) * _X)
    _weights = 0.5 * np.abs(_X[:, None] - _end) * _W
    _SIDES.append((_places, _weights[:, :, None] * np.array([_values_at(row) for row in _places])))
AT_END = _values_at(np.array([1.0]))[0]
"""Takes values at the nodes of a piece to that at its end."""


@dataclass
class Piece:
    """A piece of the period: its laws, and what ends it."""

    c: float
    g: float
    level: float
    law: tuple
    sign: float
    event: tuple | None  # ("y", level) or ("v", 0.0); None where a fixed time ends it


def solve(problem, periods, pieces, ends, y, v):
    """Return the ends of the pieces and y, v at their nodes, shape (pieces, NODES).

    `ends`, `y` and `v` are guesses; the ends of pieces without an event do not change.
    """
    two_mu, support = 2.0 / problem.body_mass, problem.bearing_stiffness / problem.body_mass
    damped = 2.0 * problem.bearing_damping_ratio * np.sqrt(support)
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-1.0 - two_mu, 0.0, -support, -damped],
            [0.0, 0.0, 0.0, 1.0],
            [-two_mu, 0.0, -support, -damped],
        ]
    )
    rates, vectors = np.linalg.eig(a)
    inverse = np.linalg.inv(vectors)
    length = periods * problem.period
    # g acts on y'' and b'': as (1 + gamma E) on the first, -(N - y) on both in these shares.
    free = (vectors[:2, :, None] * inverse[None, :, 1, None]).squeeze(-1)
    mesh = vectors[:2] * (-(1.0 + two_mu) * inverse[:, 1] - two_mu * inverse[:, 3])

    once = 1.0 / (1.0 - np.exp(rates * length))
    later = once * np.exp(rates * length)

    def operators(ends):
        """Return the matrices from both parts of g at the nodes to (y, v) at the nodes."""
        starts = np.concatenate([[0.0], ends[:-1]])
        halves = (ends - starts) / 2.0
        times = times_of(ends)
        flat, weights = times.ravel(), (halves[:, None] * _W).ravel()
        forward, backward = np.exp(np.outer(rates, flat)), np.exp(-np.outer(rates, flat)) * weights
        piece = np.repeat(np.arange(len(ends)), NODES)
        before = piece[:, None] > piece
        found = []
        for share in (free, mesh):
            pairs = np.where(
                before,
                np.real(np.einsum("xm,mt,ms->xts", share * once, forward, backward)),
                np.real(np.einsum("xm,mt,ms->xts", share * later, forward, backward)),
            )
            blocks = np.zeros((2, len(ends), NODES, NODES))
            for factor, (places, values) in zip((once, later), _SIDES, strict=True):
                delays = np.multiply.outer(halves, _X[:, None] - places)
                modes = np.exp(np.multiply.outer(rates, delays))
                response = np.real(np.tensordot(share * factor, modes, axes=1))
                blocks += np.einsum("xpkq,kqn,p->xpkn", response, values, halves)
            for i in range(len(ends)):
                own = slice(i * NODES, (i + 1) * NODES)
                pairs[:, own, own] = blocks[:, i]
            found.append(pairs.reshape(2 * flat.size, flat.size))
        return found

    def sources(y, v):
        """Return both parts of g, and their derivatives with respect to y and v."""
        parts, slopes = np.zeros((2, *y.shape)), np.zeros((2, 2, *y.shape))
        for i, piece in enumerate(pieces):
            k1, k2, k3 = piece.law
            elastic = piece.c * (y[i] - piece.level)
            parts[0, i] = 1.0 + piece.g * elastic
            parts[1, i] = elastic - y[i] + k1 * v[i] + k2 * piece.sign * v[i] ** 2 + k3 * v[i] ** 3
            slopes[0, 0, i] = piece.g * piece.c
            slopes[1, 0, i] = piece.c - 1.0
            slopes[1, 1, i] = k1 + 2.0 * k2 * piece.sign * v[i] + 3.0 * k3 * v[i] ** 2
        return parts.reshape(2, -1), slopes.reshape(2, 2, -1)

    moving = [i for i, piece in enumerate(pieces) if piece.event]

    def residual(ends, y, v, matrices):
        parts, _ = sources(y, v)
        nodes = np.concatenate([y.ravel(), v.ravel()])
        nodes = nodes - matrices[0] @ parts[0] - matrices[1] @ parts[1]
        events = [
            AT_END @ (y if pieces[i].event[0] == "y" else v)[i] - pieces[i].event[1] for i in moving
        ]
        return np.concatenate([nodes, events])

    n = y.size
    columns = np.zeros((2 * n + len(moving), len(moving)))
    for iteration in range(20):
        matrices = operators(ends)
        defect = residual(ends, y, v, matrices)
        _, slopes = sources(y, v)
        jacobian = np.zeros((defect.size, defect.size))
        jacobian[: 2 * n, : 2 * n] = np.eye(2 * n)
        for part in (0, 1):
            for of in (0, 1):
                jacobian[: 2 * n, of * n : (of + 1) * n] -= matrices[part] * slopes[part, of]
        for row, i in enumerate(moving):
            of = 0 if pieces[i].event[0] == "y" else 1
            begin = of * n + i * NODES
            jacobian[2 * n + row, begin : begin + NODES] = AT_END
        for column, i in enumerate(moving if iteration < 2 else ()):
            away = ends.copy()
            away[i] += 1e-6
            columns[:, column] = (residual(away, y, v, operators(away)) - defect) / 1e-6
        jacobian[:, 2 * n :] = columns
        step = np.linalg.solve(jacobian, defect)
        y = y - step[:n].reshape(y.shape)
        v = v - step[n : 2 * n].reshape(v.shape)
        ends = ends.copy()
        ends[moving] -= step[2 * n :]
        if np.abs(step).max() < 1e-12:
            break
    return ends, y, v


def times_of(ends):
    """Return the times of the nodes, shape (pieces, NODES)."""
    starts = np.concatenate([[0.0], ends[:-1]])
    return ((ends + starts) / 2.0)[:, None] + ((ends - starts) / 2.0)[:, None] * _X
