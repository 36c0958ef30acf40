"""The stroboscopic map and its Jacobian against closed forms, differences and the other solver."""

from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from problems import problem
from scipy.integrate import solve_ivp

from benchmarks.orbits.known import case_of
from gearmesh.dynamics.starts import coordinates
from gearmesh.model.contact import CONTACT_LOSS
from gearmesh.solvers.reduced.derivatives import variational
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.derivatives.polynomials import first_root
from gearmesh.solvers.simulation import simulate

REST = (1.0, 0.0, -2.0, 0.0)
"""Static equilibrium at the bearing stiffness 1."""


def test_ends_where_the_sweep_ends():
    for name, nu, backlash in [
        ("c-both", 0.7, 4.0),
        ("b-lubricant", 0.9, 1.0),  # both flanks touch
        ("d-lubricant", 0.81, 4.0),
        ("h-both", 1.0, 4.0),
    ]:
        case = problem(nu, name, backlash=backlash, initial_phase=0.2)
        end = simulate([case], tolerance=1e-14)[0].final_state
        moved = passage(case, REST, case.revolutions * case.teeth)
        assert moved.status == "complete"
        np.testing.assert_allclose(moved.end, coordinates(end), atol=1e-10, rtol=0)


@pytest.mark.parametrize("name", ["b-both", "b-material", "b-lubricant"])
def test_determinant_counts_the_time_in_which_linear_damping_acts(name):
    case = problem(0.9, name, backlash=1.0)
    moved = passage(case, REST, 3)
    crossings = moved.events[moved.events[:, variational.KIND] == variational.CROSSING]
    times = np.array([0.0, *crossings[:, variational.TIME], 3.0 * case.period])
    regimes = np.array([1.0, *crossings[:, variational.REGIME]])
    assert CONTACT_LOSS in regimes
    lost = np.diff(times)[regimes == CONTACT_LOSS].sum()
    acts = case.lubricant[0] * lost + case.material[0] * (3.0 * case.period - lost)
    bearing = 2.0 * case.bearing_damping_ratio * np.sqrt(case.bearing_stiffness / case.body_mass)
    expected = -(1.0 + 2.0 / case.body_mass) * acts - bearing * 3.0 * case.period
    assert np.linalg.slogdet(moved.jacobian)[1] == pytest.approx(expected, abs=1e-11)
    assert moved.log_determinant == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("name", ["b-lubricant", "b-material", "c-both", "d-lubricant", "h-both"])
def test_jacobian_is_the_limit_of_differences(name):
    case = problem(0.9, name, backlash=1.0)
    start = np.array(REST)
    moved = passage(case, start, 2)
    jacobian = np.column_stack([moved.jacobian, moved.stretched])
    errors = []
    for step in (1e-3, 1e-4, 1e-5):
        ends = [
            [passage(case, start + side * step * np.eye(4)[i], 2).end for side in (1.0, -1.0)]
            for i in range(4)
        ]
        longer, shorter = (replace(case, nu=0.9 * np.exp(side * step)) for side in (-1.0, 1.0))
        ends.append([passage(stretched, start, 2).end for stretched in (longer, shorter)])
        differences = np.array([(up - down) / (2.0 * step) for up, down in ends]).T
        errors.append(np.abs(differences - jacobian).max())
    rounding = 1e-9
    assert errors[1] < errors[0] / 50.0 + rounding
    assert errors[2] < errors[1] / 50.0 + rounding


def test_steps_do_not_matter():
    case = problem(0.9, "c-lubricant", backlash=1.0)
    whole, fine = (passage(case, REST, 5, share=share) for share in (1.0, 0.3))
    np.testing.assert_allclose(fine.end, whole.end, atol=1e-12, rtol=0)
    np.testing.assert_allclose(fine.jacobian, whole.jacobian, atol=1e-11, rtol=0)


def test_samples_are_those_of_the_sweep():
    case = problem(0.85, "c-lubricant", initial_phase=0.2, revolutions=1)
    samples = simulate([case], tolerance=1e-13, samples_per_period=32)[0].samples
    found = passage(case, REST, case.teeth, samples_per_period=32).samples
    np.testing.assert_allclose(found[:, 0], samples.y, atol=1e-10, rtol=0)
    np.testing.assert_allclose(found[:, 2], samples.a, atol=1e-9, rtol=0)
    np.testing.assert_array_equal(found[:, 3], samples.regime)


@njit
def _first_root(polynomial, end):
    return first_root(polynomial, end)


def test_first_root_misses_no_close_pair():
    for roots, expected in [
        ((0.3, 0.300001), 0.3),
        ((0.7, 0.2, 0.9), 0.2),
        ((0.0, 0.6), 0.6),  # a root at the start does not count
        ((0.5, 0.5), np.inf),  # touches 0 without a change of sign
        ((-0.1, 1.2), np.inf),
    ]:
        polynomial = np.zeros(21)
        polynomial[: len(roots) + 1] = np.poly(roots)[::-1]
        assert _first_root(polynomial, 1.0) == pytest.approx(expected, abs=1e-9)


def test_saltation_gives_the_multiplier_of_the_switched_oscillator():
    """The unit circle of `switched.yaml`; its flow is SciPy's."""
    case = case_of("switched")
    alpha, beta, gamma = (case.parameters[name] for name in ("alpha", "beta", "gamma"))

    def left(_, x):
        r = np.hypot(*x)
        return np.array([-x[1] + (1.0 - r) * x[0], x[0] + (1.0 - r) * x[1]])

    def right(_, x):
        r = np.hypot(*x)
        turn = gamma + beta - r
        return np.array(
            [alpha * (beta - r) * x[0] - turn * x[1], alpha * (beta - r) * x[1] + turn * x[0]]
        )

    def flow(field, duration, start):
        """Return the Jacobian of the flow by the variational equations."""

        def rates(t, z):
            x, deviations = z[:2], z[2:].reshape(2, 2)
            step = 1e-20
            columns = [
                np.imag(_complex_step(field, x, step * np.eye(2)[i])) / step for i in range(2)
            ]
            return np.concatenate([field(t, x), (np.array(columns).T @ deviations).ravel()])

        begin = np.concatenate([start, np.eye(2).ravel()])
        solution = solve_ivp(rates, (0.0, duration), begin, rtol=1e-12, atol=1e-13, method="DOP853")
        return solution.y[2:, -1].reshape(2, 2)

    def _complex_step(field, x, step):
        z = x + 1j * step
        r = np.sqrt(z[0] ** 2 + z[1] ** 2)
        if field is left:
            return np.array([-z[1] + (1.0 - r) * z[0], z[0] + (1.0 - r) * z[1]])
        turn = gamma + beta - r
        return np.array(
            [alpha * (beta - r) * z[0] - turn * z[1], alpha * (beta - r) * z[1] + turn * z[0]]
        )

    saltation = variational.saltation.py_func
    top, bottom, gradient = np.array([0.0, 1.0]), np.array([0.0, -1.0]), np.array([1.0, 0.0])
    enter_left = saltation(right(0.0, top), left(0.0, top), gradient)
    enter_right = saltation(left(0.0, bottom), right(0.0, bottom), gradient)
    monodromy = enter_right @ flow(left, np.pi, top) @ enter_left
    monodromy = monodromy @ flow(right, np.pi / gamma, bottom)
    multipliers = np.sort(np.abs(np.linalg.eigvals(monodromy)))
    assert multipliers == pytest.approx([case.exact["multiplier"], 1.0], abs=1e-10)


def test_a_motion_that_runs_away_says_so():
    case = replace(problem(0.7, material=(-50.0, 0.0, 0.0)), backlash=1e12)
    assert passage(case, REST, 20).status == "diverged"


@pytest.mark.parametrize(("level", "velocity"), [(0.0, -1.0), (0.0, 1.0), (-4.0, 1.0)])
def test_a_start_at_the_end_of_a_regime_goes_where_it_moves(level, velocity):
    case = problem(0.8, "b-lubricant")
    ends = [passage(case, (level + away, velocity, -2.0, 0.0)).end for away in (0.0, 1e-12, -1e-12)]
    np.testing.assert_allclose(ends[1:], [ends[0]] * 2, atol=1e-10, rtol=0)
