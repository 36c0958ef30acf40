"""What engineers state instead: torque, inertias, damping ratio, speed in rpm."""

import math

import pytest

import gearmesh as gm
from gearmesh.errors import InputError
from gearmesh.study.derived import derived
from gearmesh.study.loading import load_study

DRAWING = {"torque": "120 N m", "inertia": "0.004 kg m^2", "damping_ratio": 0.05}


def kinds(pair):
    return {parameter.name: parameter.kind for parameter in pair.parameters}


def test_the_stored_parameters_follow_from_what_is_stated(pair):
    stated = pair.replace(**DRAWING)
    radius = 0.003 * 21 / 2 * math.cos(math.radians(20))  # m
    assert stated.static_force == pytest.approx(120 / radius, rel=1e-14)
    assert stated.static_deflection == pytest.approx(120 / radius / stated.stiffness_mean)
    assert stated.reduced_mass == pytest.approx(0.004 / radius**2 / 2, rel=1e-14)
    assert stated.mass_ratio == 1.0
    stiffness, mass = stated.stiffness_mean * 1e3, stated.reduced_mass  # N/m, kg
    assert stated.damping * 1e3 == pytest.approx(2 * 0.05 * math.sqrt(stiffness * mass))
    # What is relative to them follows, too.
    assert stated.backlash == pytest.approx(8 * stated.static_deflection)
    assert stated.body_mass == pytest.approx(1000 * stated.reduced_mass)


def test_two_inertias_make_the_reduced_mass(pair):
    two = pair.replace(inertia=["0.004 kg m^2", "0.012 kg m^2"])
    radius = pair.base_radius / 1e3
    assert two.reduced_mass == pytest.approx(1 / (radius**2 / 0.004 + radius**2 / 0.012))
    assert two.mass_ratio == pytest.approx(1 / 3)
    assert two.inertia == (0.004, 0.012)


@pytest.mark.parametrize("name", DRAWING)
def test_an_alternative_is_listed_in_place_of_what_it_replaces(pair, name):
    """It is as exact as it was stated, and the other one is listed with what follows."""
    stored = {"torque": "static_deflection", "inertia": "reduced_mass", "damping_ratio": "damping"}
    stated = pair.replace(**{name: DRAWING[name]})
    assert kinds(stated)[name] == "stated"
    assert stored[name] not in kinds(stated)
    following = {quantity.name for quantity in derived(stated)}
    assert stored[name] in following
    assert name not in following
    assert name in {quantity.name for quantity in derived(pair)}
    value = getattr(stated, name)
    again = stated.replace(**{stored[name]: dict(listed(pair))[stored[name]]})
    assert stored[name] in kinds(again)
    assert again.digest() == pair.digest()
    assert value == {"torque": 120.0, "inertia": (0.004, 0.004), "damping_ratio": 0.05}[name]


def listed(pair):
    for row in pair.parameters:
        yield row.name, row.value if row.unit == "1" else f"{row.value!r} {row.unit}"


def test_a_pair_that_is_stated_either_way_is_the_same(pair):
    torque = pair.replace(torque=f"{pair.torque!r} N m")
    assert torque.static_deflection == pytest.approx(pair.static_deflection, rel=1e-15)
    inertia = pair.replace(inertia=f"{pair.inertia[0]!r} kg m^2")
    assert inertia.reduced_mass == pytest.approx(pair.reduced_mass, rel=1e-15)
    ratio = pair.replace(damping_ratio=pair.damping_ratio)
    assert ratio.damping == pytest.approx(pair.damping, rel=1e-15)


def test_a_file_states_one_of_two_and_replaces_what_it_inherits(write, pair):
    study = load_study(write("base: paper.yaml\ntorque: 120 N m\nmodule: 4 mm"))
    assert study.pair.torque == 120.0
    assert study.pair.base_radius == pytest.approx(pair.base_radius * 4 / 3)
    again = load_study(study.path, ["static_deflection=10 um"]).pair
    assert (again.static_deflection, again.backlash) == (0.01, 0.08)


MISTAKES = [
    ("torque: 120 N m\nstatic_deflection: 10 um", "torque: stated beside static_deflection; allo"),
    ("inertia: 1 kg m^2\nmass_ratio: 2", "inertia: stated beside mass_ratio; allowed is one of"),
    ("torque: 120 N", "torque: found '120 N'; unit 'N' is of another kind; expected: a torque"),
    ("torque: -1 N m", "torque: found '-1 N m'; out of range; allowed is 1e-09 to 1e+12 N*m"),
    ("torque: 1 y_st", "torque: found '1 y_st'; 'y_st' is not allowed here"),
    ("torque: 1e9 N m", "static_deflection: found"),
    ("inertia: [1 kg m^2, 1 kg m^2, 1 kg m^2]", "inertia: found a list of 3; allowed is one value"),
    ("inertia: 1 kg", "inertia: found '1 kg'; unit 'kg' is of another kind; expected: an inertia"),
    ("torque: 1 N m\nmodule: 1 y_st", "module: found '1 y_st'; 'y_st' is not allowed here"),
    ("torque: 1 N m\nmodule: [1 mm, 2 mm]", "module: found a list of 2; allowed is a single"),
    ("damping_ratio: 1 N s/mm", "damping_ratio: found '1 N s/mm'; unit 'N s/mm' where none"),
    ("torqe: 120 N m", "torqe: unknown key (did you mean 'torque'?)"),
]


@pytest.mark.parametrize(("stated", "message"), MISTAKES)
def test_a_wrong_alternative_is_reported_in_one_line(refused, stated, message):
    assert refused(f"base: paper.yaml\n{stated}").startswith(message)


def test_a_speed_in_rpm_is_that_of_wheel_3(write, pair):
    """ω_c = Z_3 2π n/60."""
    nu = 21 * 2 * math.pi * 3000 / 60 / pair.natural_frequency
    assert 3000 / pair.resonance_speed == pytest.approx(nu, rel=1e-15)
    text = "base: paper.yaml\nvariants: [c-material]\nstrong_damping: null\n"
    text += "nu: {start: 2800 rpm, stop: 3200 rpm, step: 200 rpm, values: [0.7]}\n"
    study = load_study(write(text + "time_courses: {c-material: [3000 rpm]}"))
    assert study.nu == pytest.approx(sorted([nu * 28 / 30, nu, nu * 32 / 30, 0.7]), abs=1e-10)
    assert study.time_courses["c-material"] == pytest.approx((nu,), abs=1e-10)


def test_runs_at_a_speed_are_those_at_its_mesh_frequency(pair):
    speeds, over = ["2900 rpm", "3000 rpm"], {"torque": ["60 N m", "1 N m"]}
    found = gm.sweep(pair, "c-material", speeds, revolutions=1, over=over)
    assert found.torque.values.tolist() == [60.0, 1.0]
    assert found.torque.attrs["units"] == "N*m"
    nu = 21 * 2 * math.pi * 3000 / 60 / pair.natural_frequency
    run = gm.simulate(pair.replace(torque="60 N m"), "c-material", round(nu, 10), revolutions=1)
    assert float(found.y_max.sel(torque=60.0)[0, 1]) == float(run.y_max)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"nu": "3000 rmp"}, "nu: found '3000 rmp'; unit 'rmp' where none belongs"),
        ({"nu": "1e6 rpm"}, "nu: found '1e6 rpm'; ν_s = 214.272 is out of range; allowed is 0.01"),
        ({"nu": "fast rpm"}, "nu: found 'fast rpm'; not a quantity"),
        ({"nu": "3000 rpm", "over": {"reduced_mass": ["1 kg"]}}, "nu: found '3000 rpm', but ν_s"),
    ],
)
def test_a_wrong_speed_is_one_line(pair, request_, message):
    with pytest.raises(InputError) as caught:
        gm.sweep(pair, "c-material", **request_)
    assert str(caught.value).startswith(message)
