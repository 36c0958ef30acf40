"""Limits and effects of the general terms: what each must reduce to, and what it changes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from problems import problem
from scipy.optimize import brentq

from gearmesh.model import stiffness
from gearmesh.model.functions import Harmonic
from gearmesh.model.mesh import mesh_stiffness
from gearmesh.model.problem import GeneralTerms, State, ToothFactor, Wheel
from gearmesh.solvers.full import recurrences
from gearmesh.solvers.full.coordinates import embedding
from gearmesh.solvers.full.runs import integrate

IMMOVABLE = 1e30
"""Body mass with which y_3 - y_2 keeps its value, so that y'' = 1 - N is all that is left."""

PINION = Wheel(20, 2860.0, 1.5, 8.0, (1.2, 0.8), (0.03, 0.05))
WHEEL = Wheel(40, 5720.0, 3.0, 20.0, (2.0, 1.5), (0.02, 0.04))

BASE = problem(0.85, "c-both", kept_revolutions=1, revolutions=2)


def strobes(case, tolerance=1e-12):
    response = integrate(case, tolerance, estimate_errors=False)
    assert response.status == "ok"
    return np.stack([response.strobe_y, response.strobe_v], axis=1)


def with_terms(case, **terms):
    return replace(case, terms=GeneralTerms(**terms))


def oscillator(**changes):
    """Return y'' = 1 - N with the mean stiffness and linear damping."""
    plain = problem(
        0.8,
        "b-material",
        friction_coefficient=0.0,
        stiffness_max=1.0,
        stiffness_min=1.0,
        body_mass=IMMOVABLE,
        revolutions=20,
    )
    return replace(plain, **changes)


def test_two_equal_wheels_are_the_equal_pair_to_the_last_bit():
    alone = BASE.both_wheels[0]
    np.testing.assert_array_equal(strobes(replace(BASE, wheels=(alone, alone))), strobes(BASE))


def test_three_coordinates_are_enough_without_run_out():
    case = replace(
        problem(0.85, "c-lubricant", friction_coefficient=0.0, revolutions=2),
        wheels=(PINION, WHEEL),
    )
    six = replace(case, eccentricity_3=1e-13)
    assert (embedding(case).shape[1], embedding(six).shape[1]) == (3, 6)
    np.testing.assert_allclose(strobes(case), strobes(six), atol=1e-10, rtol=0)


def test_the_ratio_of_the_teeth_alone_moves_the_pitch_point_and_the_arms():
    """Without friction only the wheels' masses on the mesh line and the bearings matter."""
    smooth = replace(BASE, friction_coefficient=0.0)
    wheel = smooth.both_wheels[0]
    geared = replace(smooth, wheels=(wheel, replace(wheel, teeth=42)))
    np.testing.assert_allclose(strobes(geared), strobes(smooth), atol=1e-11, rtol=0)
    rubbing = replace(geared, friction_coefficient=0.1)
    equal = replace(smooth, friction_coefficient=0.1)
    assert np.abs(strobes(rubbing) - strobes(equal)).max() > 1e-4


def switched(high, low):
    """Return the rectangular wave of the base case as a table with jumps."""
    fall, rise = stiffness.switch_phases(BASE.contact_ratio)
    return ((0.0, high), (fall, high), (fall, low), (rise, low), (rise, high), (1.0, high))


SAME_STIFFNESS = {
    "table": (
        BASE,
        with_terms(BASE, stiffness_table=switched(BASE.stiffness_max, BASE.stiffness_min)),
    ),
    "pair of teeth": (
        replace(BASE, stiffness_max=1.3, stiffness_min=0.65),
        with_terms(BASE, tooth_pair_stiffness=(0.65, 0.65)),
    ),
    "Fourier": (
        replace(BASE, stiffness_harmonics=3),
        with_terms(
            BASE,
            stiffness_fourier=tuple(
                (float(a), 0.0)
                for a in stiffness.fourier_amplitudes(
                    BASE.contact_ratio, BASE.stiffness_max, BASE.stiffness_min, 3
                )
            ),
        ),
    ),
    "teeth without a fault": (BASE, with_terms(BASE, tooth_factors=(ToothFactor(3, 4, 1.0),))),
}


@pytest.mark.parametrize("name", SAME_STIFFNESS)
def test_stiffness_functions_agree_where_they_should(name):
    one, other = SAME_STIFFNESS[name]
    np.testing.assert_allclose(strobes(other), strobes(one), atol=1e-11, rtol=0)


def test_a_fine_table_of_a_fourier_series_is_the_series():
    waves = with_terms(BASE, stiffness_fourier=((0.2, 0.1),))
    errors = []
    for points in (16, 32, 64):
        places = np.linspace(0.0, 1.0, points + 1)
        values = [float(mesh_stiffness(waves, place)) for place in places]
        table = with_terms(BASE, stiffness_table=tuple(zip(places.tolist(), values, strict=True)))
        errors.append(np.abs(strobes(table, 1e-10) - strobes(waves, 1e-10)).max())
    assert errors[1] < 0.35 * errors[0]
    assert errors[2] < 0.35 * errors[1] < 1e-2


def test_a_cracked_tooth_appears_once_a_revolution():
    plain = replace(BASE, revolutions=6, kept_revolutions=4, material=(0.2, 0.0, 0.0))
    spectra = []
    for case in (plain, with_terms(plain, tooth_factors=(ToothFactor(3, 4, 0.7),))):
        y = integrate(case, 1e-9, 32, estimate_errors=False).samples.y
        spectra.append(np.abs(np.fft.rfft(y)) / y.size)
    once = 4  # four kept revolutions
    assert spectra[0][once] < 1e-6
    assert spectra[1][once] > 1e-4


@pytest.mark.parametrize("wheel", [3, 2])
@pytest.mark.parametrize("order", [1.0, 0.5])
def test_torque_harmonics_have_the_linear_response(wheel, order):
    """Half of a torque's harmonic acts in y'' + k y' + y = 1 + a/2 cos(n nu t)."""
    torque = (Harmonic(order, 0.3, 0.4),)
    case = with_terms(oscillator(), **{f"torque_harmonics_{wheel}": torque})
    response = integrate(case, 1e-11, estimate_errors=False)
    omega = order * case.nu
    amplitude = 0.5 * 0.5 / math.hypot(1.0 - omega**2, case.material[0] * omega)
    assert response.y_max == pytest.approx(1.0 + amplitude, abs=1e-9)
    assert response.y_min == pytest.approx(1.0 - amplitude, abs=1e-9)


def test_torsional_damping_is_linear_damping_of_rigid_supports():
    free = oscillator(revolutions=2, material=(0.0, 0.0, 0.0))
    free = replace(free, initial_state=State(1.5, 0.0, -2.0, 0.0))
    to_frame = with_terms(free, torsional_damping=(0.2, 0.2))
    in_mesh = replace(free, material=(0.1, 0.0, 0.0))
    np.testing.assert_allclose(strobes(to_frame), strobes(in_mesh), atol=1e-11, rtol=0)


@pytest.mark.parametrize("powers", [(0.3, 0.0), (0.0, 0.2), (0.1, 0.1)])
def test_a_stiffening_mesh_comes_to_rest_where_the_forces_balance(powers):
    second, third = powers
    case = with_terms(oscillator(revolutions=40), restoring_2=second, restoring_3=third)
    rest = brentq(lambda d: d + second * d**2 + third * d**3 - 1.0, 0.0, 1.0, xtol=1e-15)
    response = integrate(case, 1e-11, estimate_errors=False)
    assert response.y_max == pytest.approx(rest, abs=1e-9)
    assert response.y_min == pytest.approx(rest, abs=1e-9)


def test_a_weak_stiffening_that_varies_is_a_force_of_its_frequency():
    """At y = 1 it has the amplitude c_2, and the motion is linear to the first order in it."""
    weak = 1e-5
    case = oscillator(revolutions=40)
    moved = with_terms(case, restoring_2=weak, restoring_fourier=((0.0, 0.0), (1.0, 0.0)))
    response = integrate(moved, 1e-12, estimate_errors=False)
    order = 2.0 * case.nu
    amplitude = weak / abs(1.0 - order**2 + 1j * case.material[0] * order)
    assert response.y_max - response.y_min == pytest.approx(2.0 * amplitude, rel=1e-3)
    still = with_terms(case, restoring_fourier=((1.0, 0.0),))
    np.testing.assert_array_equal(strobes(still), strobes(case))


def test_a_contact_that_does_not_pull():
    case = problem(0.85, "b-both")
    pulling, pressing = (
        integrate(one, 1e-11, 64, estimate_errors=False)
        for one in (case, with_terms(case, non_adhesive=True))
    )
    assert pulling.least_contact_force < -1e-3
    assert pressing.least_contact_force == pytest.approx(0.0, abs=1e-9)
    touching = pressing.samples.regime != 0
    assert pressing.samples.force_normal[touching].min() >= -1e-9
    assert pressing.contact_loss_fraction > pulling.contact_loss_fraction


def test_the_least_contact_force_is_found_between_the_samples():
    case = oscillator(revolutions=3, initial_state=State(1.5, 0.0, -2.0, 0.0), material=(0.0,) * 3)
    response = integrate(case, 1e-12, estimate_errors=False)
    assert response.least_contact_force == pytest.approx(0.5, abs=1e-10)


@pytest.mark.parametrize(("power", "level"), [(0.5, math.sqrt(1.2)), (1.0, 1.2)])
def test_damping_follows_the_stiffness(power, level):
    case = oscillator(stiffness_max=1.2, stiffness_min=1.2, revolutions=2)
    follows = with_terms(case, damping_power=power)
    scaled = replace(case, material=(case.material[0] * level, 0.0, 0.0))
    np.testing.assert_allclose(strobes(follows), strobes(scaled), atol=1e-11, rtol=0)


def test_a_constant_harmonic_of_the_backlash_is_a_wider_backlash():
    case = problem(0.9, "b-both", backlash=0.4, revolutions=2)
    wider = with_terms(replace(case, backlash=0.3), backlash_harmonics=(Harmonic(0.0, 0.1, 0.0),))
    assert integrate(case, 1e-12).inverse_mesh_fraction > 0.0
    np.testing.assert_allclose(strobes(wider), strobes(case), atol=1e-10, rtol=0)


def test_hertz_power_has_the_frequency_of_its_stiffness_at_rest():
    """At the depth 1 the force C d^p has the slope p C: small motion has the frequency sqrt(p)."""
    start = State(1.0 + 1e-5, 0.0, -2.0, 0.0)
    free = oscillator(revolutions=4, kept_revolutions=4, initial_state=start, material=(0.0,) * 3)
    response = integrate(with_terms(free, restoring_power=1.5), 1e-12, estimate_errors=False)
    peaks = response.extremum_time[response.extremum_kind == 1]
    period = np.diff(peaks).mean()
    assert period == pytest.approx(2.0 * math.pi / math.sqrt(1.5), rel=1e-9)


def test_hertz_power_of_one_is_the_linear_force_and_the_onset_does_not_matter():
    """Between two heights of free fall the flanks rebound: energy C d^(p + 1)/(p + 1) is kept."""
    case = oscillator(
        revolutions=1,
        backlash=20.0,
        material=(0.0,) * 3,
        initial_state=State(-2.0, 0.0, -2.0, 0.0),
    )
    assert with_terms(case, restoring_power=1.0) == replace(case, terms=GeneralTerms())
    response = integrate(with_terms(case, restoring_power=1.5), 1e-12, estimate_errors=False)
    deepest = brentq(lambda d: d**2.5 / 2.5 - d - 2.0, 0.0, 10.0, xtol=1e-14)
    assert response.y_max == pytest.approx(deepest, abs=1e-9)
    assert response.y_min == pytest.approx(-2.0, abs=1e-9)


def test_backlash_follows_the_centres_by_their_static_displacement():
    """Bearings of 1/0.7 and 1/0.5 give way by 1.2 in all; nothing moves across without friction."""
    plain = problem(0.9, "b-both", backlash=0.5, friction_coefficient=0.0, revolutions=2)
    heavy = replace(
        plain,
        wheels=(
            replace(PINION, teeth=21, body_mass=IMMOVABLE, bearing_stiffness=(1 / 0.7, 1.0)),
            replace(WHEEL, teeth=21, body_mass=IMMOVABLE, bearing_stiffness=(1 / 0.5, 1.0)),
        ),
    )
    wider = 0.5 + 2.0 * math.sin(plain.pressure_angle) ** 2 * 1.2
    follows, fixed = (
        with_terms(heavy, backlash_follows_centres=True),
        replace(heavy, backlash=wider),
    )
    assert integrate(fixed, 1e-12).inverse_mesh_fraction > 0.0
    np.testing.assert_allclose(strobes(follows), strobes(fixed), atol=1e-9, rtol=0)
    assert np.abs(strobes(follows) - strobes(heavy)).max() > 1e-2


def test_flanks_that_deviate_by_nothing_are_those_of_the_pair():
    """Errors of 0 and relief of next to nothing still make each pair of teeth touch singly."""
    case = replace(BASE, backlash=0.5)
    even = with_terms(case, pitch_errors_3=(0.0,) * 21)
    np.testing.assert_allclose(strobes(even), strobes(case), atol=1e-10, rtol=0)
    spared = with_terms(case, tip_relief=(1e-14, 1e-14), tip_relief_length=(0.5, 0.4))
    np.testing.assert_allclose(strobes(spared), strobes(case), atol=1e-10, rtol=0)


def test_a_tooth_that_stands_back_is_touched_once_a_revolution():
    """In slow rotation the mesh follows its teeth: wheel 3 turns further by the missing flank."""
    errors = tuple(-0.4 if tooth == 4 else 0.0 for tooth in range(21))
    case = problem(0.02, "b-both", contact_ratio=1.2, friction_coefficient=0.0, revolutions=1)
    slow = replace(case, material=(0.5, 0.0, 0.0), stiffness_max=1.0, stiffness_min=1.0)
    y = [integrate(one, 1e-9, 64, estimate_errors=False).samples.y.reshape(21, 64)
         for one in (slow, with_terms(slow, pitch_errors_3=errors))]  # fmt: skip
    single = y[1][:, 28:36] - y[0][:, 28:36]  # around single contact of tooth p
    assert np.delete(single, 4, axis=0) == pytest.approx(0.0, abs=0.02)
    assert single[4] == pytest.approx(0.4, abs=0.02)


def test_tip_relief_of_the_static_deflection_takes_the_shock_out_of_the_mesh():
    """With C_a = y at the tip, a pair takes over its load without a jump (Lin and others 1994)."""
    spring = with_terms(
        problem(0.25, "b-both", friction_coefficient=0.0, material=(0.2, 0.0, 0.0)),
        tooth_pair_stiffness=(0.62, 0.62),
    )
    length = spring.contact_ratio - 1.0
    relieved = replace(
        spring,
        terms=replace(spring.terms, tip_relief=(1.6, 1.6), tip_relief_length=(length, length)),
    )
    plain, spared = (
        np.ptp(integrate(one, 1e-9, 256, estimate_errors=False).samples.force_normal)
        for one in (spring, relieved)
    )
    assert spared < 0.5 * plain


def test_an_interruption_while_code_is_made_ends_the_run_and_harms_no_other(monkeypatch):
    def interrupted(function):
        raise KeyboardInterrupt

    unusual = replace(BASE, contact_ratio=1.31, stiffness_harmonics=3)
    monkeypatch.setattr(recurrences, "_compiled", {})
    recurrences._recurrences.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(recurrences, "_compile", interrupted)
        with pytest.raises(KeyboardInterrupt):
            integrate(unusual)
    assert integrate(unusual).status == "ok"
