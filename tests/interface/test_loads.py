"""Tooth force, transmission error, bearing forces and spectra, against closed forms."""

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.model.variants import variant
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.loads import loads
from gearmesh.solvers.simulation import simulate

NU = 0.8
RATIO = 0.2
"""Of the damping in the mesh and in the bearings: the transient dies out."""


@pytest.fixture(scope="module")
def wavy(pair):
    """A linear pair: constant stiffness, a wavy profile, bodies that move, no friction."""
    return pair.replace(
        stiffness_ratio=1,
        damping_ratio=RATIO,
        bearing_damping_ratio=RATIO,
        body_mass="4 m_red",
        friction_coefficient=0,
        profile_deviation=[["0.05 y_st", "0.1 y_st"], ["0 um", "0.02 y_st"]],
        initial_phase=0,
        revolutions=12,
    )


@pytest.fixture(scope="module")
def run(wavy):
    return gm.simulate(wavy, "b-both", nu=NU)


def closed_form(pair):
    """Return the complex amplitudes of u, b and N for harmonics 1 and 2, in y_st and F_st.

    y = u + b + f with f = Re(sum of F e^(i n nu t)), u'' = 1 - N, b'' = -2 mu N - 2 zeta w b' -
    w^2 b, and N = y + 2 D y'.
    """
    mu = 1 / 4
    w = np.sqrt(mu * pair.bearing_stiffness / pair.stiffness_mean)
    s = 1j * NU * np.array([1, 2])
    f = np.array([0.05 - 0.1j, -0.02j])
    law = 1 + 2 * RATIO * s
    support = s * s + 2 * RATIO * w * s + w * w
    y = f / (1 + law * (1 / (s * s) + 2 * mu / support))
    return -law * y / (s * s), -2 * mu * law * y / support, law * y


def test_a_linear_pair_has_the_loads_of_the_closed_form(wavy, run):
    u, b, normal = closed_form(wavy)
    found = gm.spectrum(run, "transmission_error", "force_normal", "force_bearing_2", "y")
    found = found.sel(order=[0.0, 1.0, 2.0])
    y_st, static = wavy.static_deflection, wavy.static_force
    assert found.transmission_error.values[1:] / y_st == pytest.approx(abs(u), rel=1e-6)
    assert found.force_normal.values / static == pytest.approx([1, *abs(normal)], rel=1e-6)
    # Half of b is the displacement of a body, b_b = 2 zeta sqrt(c_b m).
    stiffness = wavy.bearing_stiffness / wavy.stiffness_mean
    bearing = stiffness + 2 * RATIO * np.sqrt(4 * stiffness) * 1j * NU * np.array([1, 2])
    force = abs(bearing * b / 2)
    assert found.force_bearing_2.values / static == pytest.approx([1, *force], rel=1e-6)


def test_the_scalars_are_those_of_the_waves(wavy, run):
    u, _, normal = closed_form(wavy)
    angle = np.linspace(0, 2 * np.pi, 100_000)[:, None] * [1, 2]
    wave = 1 + np.real(normal * np.exp(1j * angle)).sum(axis=1)
    error = np.real(u * np.exp(1j * angle)).sum(axis=1)
    assert float(run.dynamic_factor) == pytest.approx(wave.max(), rel=1e-6)
    assert float(run.force_max) == float(run.dynamic_factor) * wavy.static_force
    assert float(run.force_min) / wavy.static_force == pytest.approx(wave.min(), rel=1e-6)
    assert float(run.transmission_error_rms_rel) == pytest.approx(error.std(), rel=1e-4)
    assert float(run.transmission_error_range_rel) == pytest.approx(np.ptp(error), rel=1e-6)
    sampled = float(np.abs(run.force_bearing_3).max())
    assert sampled <= float(run.force_bearing_3_max) < sampled * (1 + 1e-3)


@pytest.mark.parametrize(("name", "nu"), [("g-both", 0.9), ("c-lubricant", 0.85)])
def test_both_solvers_agree_on_the_loads(pair, name, nu):
    problem = pair.replace(body_mass="10 m_red").problem(variant(name), nu)
    [fast], general = simulate([problem], 1e-10, 256), integrate(problem, 1e-10, 256)
    for force in ("force_normal", "force_bearing_3", "force_bearing_2", "transmission_error"):
        one, other = (getattr(response.samples, force) for response in (fast, general))
        assert one == pytest.approx(other, abs=1e-7)
    one, other = (loads(problem, response.samples) for response in (fast, general))
    # The reduced solver estimates the force at a jump from the sample before it: 4e-6 here.
    assert one.force_max == pytest.approx(other.force_max, abs=1e-5)


def test_extremes_at_jumps_do_not_depend_on_the_samples(pair):
    """Linear damping pulls where the teeth part, and the stiffness switches under load."""
    found = [
        gm.simulate(pair, "b-both", 0.85, samples_per_period=samples) for samples in (256, 4096)
    ]
    coarse, fine = ([float(run.force_max), float(run.force_min)] for run in found)
    assert float(found[0].contact_loss_fraction) > 0.1
    assert fine[1] < 0.0
    assert coarse == pytest.approx(fine, abs=3e-4 * pair.static_force)


def test_force_normal_is_zero_in_the_gap_without_oil_and_force_dynamic_is_not(pair):
    run = gm.simulate(pair, "b-material", 0.85)
    gap = run.regime == 0
    assert bool(gap.any())
    assert float(abs(run.force_normal.where(gap)).max()) == 0.0
    assert float(run.force_dynamic.where(gap).max()) < 0.0


@pytest.mark.parametrize("direction", [None, "up"])
def test_the_loads_of_a_sweep_are_those_of_its_runs(pair, direction):
    found = gm.sweep(
        pair, "b-both", [0.8, 0.9], direction=direction, loads=True, revolutions=2
    ).squeeze("variant")
    first = gm.simulate(pair, "b-both", 0.8, revolutions=2)
    second = gm.simulate(pair, "b-both", 0.9, revolutions=2, start=first if direction else None)
    for name in ("dynamic_factor", "transmission_error_rms_rel", "force_bearing_3_max"):
        assert found[name].values.tolist() == [float(first[name]), float(second[name])]


def test_a_campbell_map_is_the_spectra_of_the_runs(pair):
    speeds = ["11000 rpm", "12000 rpm"]
    found = gm.campbell(pair, "c-both", speeds, highest_order=3, revolutions=2)
    assert found.speed.values == pytest.approx([11000, 12000], rel=1e-9)
    run = gm.spectrum(gm.simulate(pair, "c-both", "12000 rpm", revolutions=2))
    cell = found.force_normal.isel(nu=1).values
    assert cell.tolist() == run.force_normal.sel(order=slice(None, 3.0)).values.tolist()
    mesh = found.isel(nu=1).sel(order=1.0)
    assert float(mesh.frequency) == pytest.approx(21 * 12000 / 60, rel=1e-9)
    assert float(mesh.shaft_order) == 21.0
    assert set(found.attrs) == {"variant", "parameters"}


@pytest.mark.parametrize("names", [("status",), ("y", "force"), ("time",)])
def test_what_has_no_spectrum_is_refused_in_one_line(run, names):
    with pytest.raises(gm.InputError, match=r"^spectrum: found '\w+'; allowed are y, v, a"):
        gm.spectrum(run, *names)
