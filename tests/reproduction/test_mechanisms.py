"""What lies behind the curves: special points against closed forms, and what is made of them."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from scipy.linalg import expm
from scipy.optimize import brentq

from gearmesh.interface.orbits import find_orbit
from gearmesh.reproduction.mechanisms import bands, files, tables
from gearmesh.reproduction.mechanisms.answers import Points, special_table, time_constant, windows
from gearmesh.reproduction.mechanisms.explanations import mechanisms
from gearmesh.reproduction.mechanisms.orbits import WITHOUT_SUPPORTS, branches, doubled

EPSILON, KAPPA = 1.569, 0.5879
"""Contact ratio and stiffness ratio, as the paper prints them."""

MEAN = EPSILON - 1.0 + KAPPA * (2.0 - EPSILON)
"""C_s/C_max, eq. (5)."""

PIECES = ((EPSILON - 1.0, 1.0 / MEAN), (2.0 - EPSILON, KAPPA / MEAN))
"""Share of the mesh period and C/C_s of both stiffnesses."""


def rates(stiffness):
    """Return the matrix of (y, y', 1) for y'' + C/C_s y = 1."""
    return np.array([[0.0, 1.0, 0.0], [-stiffness, 0.0, 1.0], [0.0, 0.0, 0.0]])


def trace(nu):
    """Return the trace of the undamped motion in contact over a mesh period (Meissner)."""
    (a, first), (b, second) = ((share, math.sqrt(level)) for share, level in PIECES)
    a, b = 2.0 * math.pi / nu * a * first, 2.0 * math.pi / nu * b * second
    both = first / second + second / first
    return 2.0 * math.cos(a) * math.cos(b) - both * math.sin(a) * math.sin(b)


def lowest(nu):
    """Return the least y of the undamped periodic motion in contact."""
    period = 2.0 * math.pi / nu
    steps = [expm(rates(level) * share * period / 4000) for share, level in PIECES]
    whole = np.linalg.matrix_power(steps[1], 4000) @ np.linalg.matrix_power(steps[0], 4000)
    state = np.append(np.linalg.solve(np.eye(2) - whole[:2, :2], whole[:2, 2]), 1.0)
    course = [state]
    for step in steps:
        for _ in range(4000):
            course.append(step @ course[-1])
    y = np.array(course)[:, 0]
    i = int(np.argmin(y))
    before, at, after = y[i - 1], y[i], y[(i + 1) % len(y)]
    return at - (after - before) ** 2 / (8.0 * (before - 2.0 * at + after))  # of a parabola


@pytest.fixture(scope="module")
def lubricant(pair):
    """Branches of c-• without friction on rigid supports, and those of period 2."""
    simpler = pair.replace(**WITHOUT_SUPPORTS)
    single = branches(simpler, "c-lubricant", (0.64, 0.83))
    return [*single, *doubled(single, (0.64, 0.83))]


@pytest.fixture(scope="module")
def rows(lubricant):
    return tables.rows("c-lubricant", lubricant, {})


def test_the_flips_are_the_ends_of_the_tongue_in_closed_form(rows):
    ends = [brentq(lambda nu: trace(nu) + 2.0, *ends) for ends in ((0.64, 0.66), (0.66, 0.68))]
    assert ends == pytest.approx([0.65562, 0.66734], abs=5e-6)
    assert Points(rows).of("c-lubricant", "flip") == pytest.approx(ends, abs=1e-8)


def test_the_orbit_in_contact_grazes_where_its_least_y_is_0(rows):
    grazing = brentq(lowest, 0.78, 0.80, xtol=1e-12)
    assert Points(rows).first("c-lubricant", "grazing_front") == pytest.approx(grazing, abs=1e-7)


def test_both_motions_exist_between_the_folds_and_nowhere_else(lubricant, rows, pair):
    low, high = Points(rows).of("c-lubricant", "fold")
    table = tables.table({"c-lubricant": lubricant}, pair.static_deflection)
    single = table.isel(point=np.flatnonzero(table["periods"] == 1))
    for nu, expected in ((low - 1e-3, 1), (0.5 * (low + high), 3), (high + 1e-3, 1)):
        crossings = np.diff(np.sign(single["nu"].values - nu)) != 0
        assert crossings.sum() == expected


def test_a_table_gives_stability_period_and_signature_of_each_point(lubricant, pair):
    table = tables.table({"c-lubricant": lubricant}, pair.static_deflection)
    neutral = table.isel(point=np.flatnonzero(table["stability"] == 0))
    assert set(neutral["signature"].values) == {"normal_mesh"}
    assert {*table["periods"].values.tolist()} == {1, 2}
    assert all("long_name" in variable.attrs for variable in table.variables.values())
    assert table["y_max"].attrs["units"] == "mm"
    size = np.hypot(table["multipliers_real"], table["multipliers_imaginary"]).max("multiplier")
    assert (size.values[table["stability"] == 1] < 1.0).all()
    assert (size.values[table["stability"] == -1] > 1.0).all()
    assert table["y_max"].values == pytest.approx(
        table["y_max_rel"].values * pair.static_deflection, rel=1e-12
    )


def test_the_same_branches_give_the_same_bytes(lubricant, study, pair, tmp_path):
    table = tables.table({"c-lubricant": lubricant}, pair.static_deflection)
    for name in ("one.nc", "two.nc"):
        files.write(tmp_path / name, table, study, "branches")
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


def test_rows_hold_more_than_ten_digits_and_the_orbit_itself(rows, lubricant):
    held = json.loads(json.dumps(rows))
    found = [point for branch in lubricant for point in branch.special]
    assert {row["nu"] for row in held} <= {point.nu for point in found}
    assert all(len(row["state"]) == 4 and len(repr(row["nu"])) >= 12 for row in held)
    # The flip belongs to the orbit of the mesh period, so the branch from it does not repeat it.
    flips = [row for row in held if row["kind"] == "flip" and row["periods"] == 1]
    assert len(flips) == 2


def test_the_table_of_special_points_has_both_sets_side_by_side(rows):
    own = [{**row, "parameters": {"friction_coefficient": 0}} for row in rows]
    listed = special_table([*rows, *own])
    assert all(one == other for *_, one, other in listed)
    flips = next(line for line in listed if line[1:3] == ("flip", 1))
    assert flips[3] == ["0.6556243359", "0.6673416316"]


def test_a_claim_names_its_orbit_and_the_value_of_five_revolutions():
    point = {"variant": "c-material", "periods": 1, "kind": "switching", "nu": 0.63863000246}
    found = mechanisms([point], {"loop_end": {"c-material": 0.6386265}})
    assert set(found) == {"F3.2", "F5.1", "F5.2"}
    assert "0.638630" in found["F3.2"] and "0.6386;" not in found["F3.2"]
    assert mechanisms([point], {}) == {}


def test_a_band_with_smooth_edges_is_told_from_one_with_steps():
    nu = np.concatenate([np.linspace(0.6, 0.8, 81), np.linspace(1.1, 1.2, 41)])
    high = 2.0 + 0.1 * np.sin(20.0 * nu)
    high[np.abs(nu - 0.66) < 0.01] += 1.0
    spread = np.where(nu < 1.0, 0.5, 0.25)
    smooth = bands.band(nu, high, -0.05 + 0.0 * nu, spread, math.nan)
    assert smooth["smooth"] == 1.0
    assert smooth["growth"] == pytest.approx(1.5, abs=0.1)
    assert (smooth["below"], smooth["above"]) == (0.5, 0.25)
    high[nu > 0.72] += 0.4
    stepped = bands.band(nu, high, -0.05 + 0.0 * nu, spread, math.nan)
    assert 0.95 < stepped["smooth"] < 1.0


def test_the_damping_of_the_mesh_vanishes_towards_the_grazing(pair):
    times = [time_constant(pair, "c-lubricant", nu) for nu in (1.05, 1.1, 1.12, 1.128)]
    orbit = find_orbit(pair, "c-lubricant", 1.12)
    bodies, mesh = np.abs(orbit.multipliers[[0, 2]])
    assert times[2] == pytest.approx(-1.0 / math.log(mesh), rel=1e-9)
    assert bodies > mesh  # the bodies on their bearings are not what the answer is about
    assert times[0] < 0.5 * times[1] < 0.2 * times[2] < 0.1 * times[3]
    assert math.isnan(time_constant(pair, "c-lubricant", 1.15))  # nothing is damped in contact


def test_the_windows_in_which_most_phases_lose_contact_are_all_named():
    nu = np.linspace(0.6, 0.7, 6)
    lost = np.zeros((1, 6, 4))
    lost[0, [1, 2, 4, 5], :3] = lost[0, [2, 4], 3] = lost[0, 3, 0] = 0.2
    y_max = np.array([1.0, 2.1, 2.1, 2.1, 3.1, 3.1])[None, :, None] * np.ones((1, 6, 4))
    axes = "revolutions", "nu", "phase"
    phases = xr.Dataset(
        {
            "contact_loss_fraction": (axes, lost),
            "share": (axes[:2], (lost > 0.05).mean(axis=2)),
            "y_max_rel": (axes, y_max),
        },
        {"nu": nu},
    )
    columns = {
        "variant": ["c-lubricant"] * 6,
        "stability": [1, 1, 1, 1, -1, -1],
        "branch": [0, 0, 1, 1, 2, 2],
        "periods": [3, 3, 1, 1, 5, 5],
        "nu": [0.6, 0.67, 0.6, 0.71, 0.6, 0.71],
        "y_max_rel": [2.0, 2.0, 3.0, 3.0, 2.1, 2.1],
    }
    branches = xr.Dataset({name: ("point", values) for name, values in columns.items()})
    one, other = windows(phases, branches)
    assert (one["from"], one["to"], one["periods"]) == (nu[1], nu[2], 3)
    assert one["all"] == (nu[2], nu[2]) and not one["last"]
    assert (other["from"], other["periods"], other["last"]) == (nu[4], 1, True)
