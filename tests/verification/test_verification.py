"""`make verify` itself: its equations, what it notices, and what its hashes are blind to.

The equations of `verification` are held against those of `independent`, which are stated in all
six coordinates; the library takes no part in either.
"""

import json
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from independent import CONTACT_LOSS, INVERSE_MESH, NORMAL_MESH, Mode, rates

from gearmesh.data import casefile
from gearmesh.model.variants import VARIANTS, variant
from gearmesh.solvers.simulation import simulate
from gearmesh.study.cases import Case

pytest.importorskip("heyoka", reason="heyoka has wheels for Linux only")

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))  # verification is a folder of the project, not of the package

from verification import numbers, runs, statement  # noqa: E402
from verification.comparison import DISPLACEMENT, compare  # noqa: E402

PAPER = ROOT / "config" / "paper.yaml"
STATED = statement.load(PAPER)


@pytest.mark.parametrize("name", [*VARIANTS, "c-material-5x"])
def test_equations_are_those_in_six_coordinates(name, pair):
    rng = np.random.default_rng(1)
    run = statement.run(STATED, name, 0.8)
    problem = pair.problem(variant(name), 0.8)
    for regime in (NORMAL_MESH, CONTACT_LOSS, INVERSE_MESH):
        for index, piece in enumerate(run.pieces):
            y, v, body, body_v = rng.normal(size=4)
            inside = (piece.start + piece.end) / 2 + pair.initial_phase
            wheel, wheel_v = (y - body) / 2, (v - body_v) / 2
            x = [wheel, wheel, body / 2, -body / 2, 0, 0]
            x += [wheel_v, wheel_v, body_v / 2, -body_v / 2, 0, 0]
            derivative = rates(problem, inside * problem.period, x, Mode(regime, inside))
            expected = derivative[6] + derivative[7] + derivative[8] - derivative[9]
            state = (y, v / run.velocity, body, body_v / run.velocity)
            found = runs.acceleration(run, np.array(index), np.array(regime), state)
            assert found * run.velocity**2 == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_cases_are_those_of_the_study(study):
    stated = {(v, nu) for v, nus in statement.frequencies(STATED).items() for nu in nus}
    assert stated == {(case.variant.name, case.nu) for case in study.cases}


@pytest.fixture(scope="module")
def verified(pair, tmp_path_factory):
    """A case file of the library, and its run by heyoka."""
    nu, case = 0.9, Case(variant("c-lubricant"), 0.9, time_course=True)
    problem = pair.problem(case.variant, nu)
    [response] = simulate([problem], pair.tolerance, pair.samples_per_period)
    path = tmp_path_factory.mktemp("case") / "nu-0.9000.nc"
    casefile.write_case(path, casefile.attributes(pair, case), casefile.record(response, pair))
    run = statement.run(STATED, case.variant.name, nu)
    [outcome], [displaced] = runs.solve([run], samples=True), runs.solve([run], DISPLACEMENT)
    return path, run, outcome, displaced


def test_the_library_agrees_in_all_variables(verified):
    found = compare(*verified)
    assert found.faults == []
    assert not found.sensitive
    assert {name.removesuffix("_rel") for name in found.differences} >= {"a", "force_friction"}
    assert max(found.differences.values()) < 1e-8


@pytest.mark.parametrize(
    ("name", "place", "change"),
    [
        ("y_rms", (), 2e-8),
        ("extremum_y_rel", 3, 2e-6),
        ("extremum_time", 0, 1e-8),
        ("extremum_kind", 2, -2),
        ("n_contact_losses", (), 1),
        ("strobe_v", 50, np.nan),
        ("force_friction", 100, 1.0),
        ("regime", 7, -1),
        ("status", (), 1),
    ],
)
def test_a_changed_number_is_named(verified, tmp_path, name, place, change):
    path, *rest = verified
    changed = tmp_path / path.name
    changed.write_bytes(path.read_bytes())
    with netCDF4.Dataset(changed, "a") as file:
        file.set_auto_mask(False)
        file[name][place] = file[name][place] + change
    assert [fault.partition(":")[0] for fault in compare(changed, *rest).faults] == [name]


def test_a_chaotic_run_is_compared_before_its_orbits_separate(pair, tmp_path):
    case = Case(variant("a-conservative"), 0.8)
    [response] = simulate([pair.problem(case.variant, case.nu)], pair.tolerance)
    path = tmp_path / "nu-0.8000.nc"
    casefile.write_case(path, casefile.attributes(pair, case), casefile.record(response, pair))
    run = statement.run(STATED, "a-conservative", 0.8)
    [outcome], [displaced] = runs.solve([run]), runs.solve([run], DISPLACEMENT)
    found = compare(path, run, outcome, displaced)
    assert found.sensitive
    assert 10 < found.comparable < 105
    assert found.faults == []


def _results(folder, kind, title, value):
    """Write results of two cases, with one number that is free."""
    folder = folder / f"{kind}-{title}-{value}"
    for nu in ("0.6000", "0.7000"):
        path = folder / "cases" / "c-material" / f"nu-{nu}.nc"
        path.parent.mkdir(parents=True, exist_ok=True)
        with netCDF4.Dataset(path, "w", format=kind) as file:
            file.title = title
            file.createVariable("y_max", "f8")[...] = 1.0 if nu == "0.6000" else value
            file.createVariable("status", "i1")[...] = 0
    for name in numbers.DATASETS:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(path.read_bytes())
    (folder / "datasets" / "thresholds.json").write_text('{"jump": 0.65}')
    (folder / "claims.json").write_text(json.dumps([{"id": "F2.1", "measured": 0.65}]))
    return folder


def test_hashes_are_of_numbers_and_not_of_files(tmp_path):
    published = tmp_path / "published.sha256"
    numbers.publish(_results(tmp_path, "NETCDF4", "one", 2.0), published)
    again = numbers.compare(_results(tmp_path, "NETCDF3_CLASSIC", "other", 2.0), published)
    assert again.agree
    last_bit = _results(tmp_path, "NETCDF4", "one", np.nextafter(2.0, 3.0))
    found = numbers.compare(last_bit, published)
    assert not found.agree
    assert found.differing == (
        "cases/c/y_max",
        *(f"{name}/y_max" for name in sorted(numbers.DATASETS)),
    )
    assert found.missing == found.unpublished == ()
