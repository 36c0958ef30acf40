"""The recurrences of both solvers against the one statement of the laws, evaluated on series."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from problems import problem

from gearmesh.model.contact import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH, elastic_force
from gearmesh.model.friction import friction_force
from gearmesh.model.motion import Mode, accelerations, relative_motion
from gearmesh.solvers.full import runs as general
from gearmesh.solvers.full import series as full_series
from gearmesh.solvers.full.coordinates import kinds_of_period
from gearmesh.solvers.full.recurrences import recurrences
from gearmesh.solvers.full.roots import WIDTH
from gearmesh.solvers.full.tape import Y
from gearmesh.solvers.reduced import taylor
from gearmesh.solvers.reduced import workspace as rows
from gearmesh.solvers.simulation import simulate

ORDER = 9


class Series:
    """A truncated power series of time, with the operations that the laws need."""

    def __init__(self, coefficients):
        self.c = np.zeros(ORDER + 1)
        self.c[: len(coefficients)] = coefficients

    def _other(self, other):
        return other if isinstance(other, Series) else Series([float(other)])

    def __add__(self, other):
        return Series(self.c + self._other(other).c)

    def __neg__(self):
        return Series(-self.c)

    def __sub__(self, other):
        return Series(self.c - self._other(other).c)

    def __rsub__(self, other):
        return self._other(other) - self

    def __mul__(self, other):
        return Series(np.convolve(self.c, self._other(other).c)[: ORDER + 1])

    def __truediv__(self, number):
        return Series(self.c / number)

    def __abs__(self):
        return self if self.c[0] > 0.0 else -self

    def __round__(self):
        return round(self.c[0])

    def _turned(self):
        """Return exp(i self) by its own series."""
        rest = Series([0.0, *self.c[1:]])
        powers = [Series([1.0])]
        for k in range(1, ORDER + 1):
            powers.append(powers[-1] * rest / k)
        total = sum(1j**k * power.c for k, power in enumerate(powers))
        return total * np.exp(1j * self.c[0])

    def sin(self):
        return Series(self._turned().imag)

    def cos(self):
        return Series(self._turned().real)

    __radd__, __rmul__ = __add__, __mul__


def stated_series(case, time, state, mode):
    """Return the coefficients of q and of y, shape (7, ORDER + 1), from `accelerations`."""
    q = np.zeros((6, ORDER + 1))
    q[:, 0], q[:, 1] = state[:6], state[6:]
    k = np.arange(1, ORDER + 1)
    moment = Series([time, 1.0])
    for order in range(ORDER - 1):
        places = [Series(row) for row in q]
        rates = [Series(row[1:] * k) for row in q]
        a = accelerations(case, moment, places, rates, mode)
        for i in range(6):
            q[i, order + 2] = a[i].c[order] / ((order + 1) * (order + 2))
    y, _ = relative_motion(case, moment, [Series(row) for row in q], [Series([0.0])] * 6)
    return np.vstack([q, y.c])


@njit
def compiled_series(cases, modes, state, tape, series):
    full_series.begin(cases[0], modes[0], state, tape, 0, series)
    full_series.expand(cases[0], modes[0], tape, 0, series, cases[0].order)


RUN_OUT = problem(
    0.8,
    "g-both",
    friction_coefficient=0.2,
    eccentricity_3=0.5,
    eccentricity_2=0.3,
    eccentricity_angle=1.0,
    base_radius=300.0,
    body_mass=3.0,
)


@pytest.mark.parametrize("regime", [NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH])
@pytest.mark.parametrize(
    ("part", "slip_sign"),
    # In double contact, part 0, the flanks do not stick.
    [(0, 1), (0, -1), (1, 1), (1, -1), (1, 0), (2, 1), (2, -1), (2, 0)],
)
def test_the_full_recurrence_is_the_statement(regime, part, slip_sign):
    cases = general._case(RUN_OUT, 6)
    cases["order"] = ORDER
    phases, _ = kinds_of_period(RUN_OUT)
    code = recurrences(RUN_OUT, phases, sampled=False)
    segments = general._segments(RUN_OUT)[0]
    start = 0.0 if part == 0 else segments["end"][part - 1]
    modes = np.zeros(1, full_series.MODE)
    modes["segment"] = part
    modes["period"], modes["time"] = 3, 0.5 * (start + segments["end"][part])
    modes["regime"], modes["run_out_sign"], modes["slip_sign"] = regime, -1, slip_sign
    time = 3 * RUN_OUT.period + modes["time"][0]
    state = np.random.default_rng(part).normal(size=12)
    if slip_sign == 0:
        state[6 + 4] = state[6 + 5]
    _, rate = relative_motion(RUN_OUT, time, state[:6], state[6:])
    modes["direction"] = np.sign(rate)
    series = np.zeros((code.height, WIDTH))
    compiled_series(cases, modes, state, (code.numbers, code.branches), series)
    mode = Mode(regime, time / RUN_OUT.period, -1, slip_sign)
    expected = stated_series(RUN_OUT, time, state, mode)
    found = series[[*range(6), Y], : ORDER + 1]
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


class Number(float):
    """A float with the fused multiply-add that the unrolled recurrence asks for."""

    def __add__(self, other):
        return Number(float(self) + other)

    def __sub__(self, other):
        return Number(float(self) - other)

    def __mul__(self, other):
        return Number(float(self) * other)

    def __neg__(self):
        return Number(-float(self))

    def times_plus(self, factor, summand):
        return self * factor + summand


@pytest.mark.parametrize("regime", [NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH])
@pytest.mark.parametrize("powers", [1, 2, 3])
@pytest.mark.parametrize("phase", [0.1, 0.4, 0.6])
def test_the_reduced_recurrence_is_the_statement(regime, powers, phase):
    name = {1: "b-both", 2: "e-both", 3: "g-both"}[powers]
    case = problem(0.8, name, friction_coefficient=0.2, body_mass=3.0, backlash=0.7)
    y, v, b, rate = np.random.default_rng(powers).normal(size=4)
    state = np.zeros(12)
    state[[0, 1]], state[[6, 7]] = 0.5 * (y - b), 0.5 * (v - rate)
    state[[2, 3]], state[[8, 9]] = [0.5 * b, -0.5 * b], [0.5 * rate, -0.5 * rate]
    expected = stated_series(case, phase * case.period, state, Mode(regime, phase))
    law = case.lubricant if regime == CONTACT_LOSS else case.material
    stiffness = case.stiffness_max if phase < 0.2 else case.stiffness_min
    gamma = {0.1: 0.0, 0.4: 1.0, 0.6: -1.0}[phase]
    work = dict.fromkeys(range(rows.N_ROWS), Number(0.0))
    work |= {
        rows.Y: y,
        rows.Y + 1: v,
        rows.B: b,
        rows.B + 1: rate,
        rows.ELASTIC: stiffness * (regime != CONTACT_LOSS),
        rows.OFFSET: -case.backlash * (regime == INVERSE_MESH),
        rows.LINEAR: law[0],
        rows.QUADRATIC: law[1],
        rows.CUBIC: law[2],
        rows.SIGN: np.sign(v),
        rows.FRICTION: case.friction_coefficient * math.tan(case.pressure_angle) * gamma,
        rows.LOAD: 1.0,
        rows.TWO_MU: 2.0 / case.body_mass,
        rows.BEARING_STIFFNESS: case.bearing_stiffness / case.body_mass,
        rows.BEARING_DAMPING: 2.0
        * case.bearing_damping_ratio
        * math.sqrt(case.bearing_stiffness / case.body_mass),
    }
    work = {row: Number(value) for row, value in work.items()}
    taylor._expand(work, powers)
    found = [[work[first + k] for k in range(ORDER)] for first in (rows.Y, rows.B)]
    np.testing.assert_allclose(found[0], expected[6, :ORDER], rtol=1e-11, atol=1e-13)
    body = expected[2, :ORDER] - expected[3, :ORDER]
    np.testing.assert_allclose(found[1], body, rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("backlash", [0.4, 4.0])
def test_the_sampled_forces_are_the_statement(backlash):
    case = problem(0.85, "b-lubricant", backlash=backlash, friction_coefficient=0.1)
    (response,) = simulate([replace(case, revolutions=1)], samples_per_period=32)
    samples = response.samples
    elastic = elastic_force(samples.y, samples.stiffness, samples.regime, backlash)
    phase = samples.time / case.period % 1.0
    single = samples.stiffness == case.stiffness_min
    gamma = single * np.where(phase < 0.5, 1.0, -1.0)
    expected = friction_force(elastic, 0.1, gamma, 1.0, 1.0)
    away = np.abs(phase - 0.5) > 1e-9
    np.testing.assert_allclose(samples.force_friction[away], expected[away], rtol=1e-14, atol=1e-15)
