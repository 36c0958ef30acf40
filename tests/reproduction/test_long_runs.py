"""How the cases of the study end: the dataset, and what the report says of it."""

from dataclasses import replace

import numpy as np
import pytest

from gearmesh.data.datasets import open_dataset
from gearmesh.dynamics.attraction.classification import classify
from gearmesh.reproduction.mechanisms import files
from gearmesh.reproduction.mechanisms.long_runs import FLAGS, shares, table
from gearmesh.solvers.simulation import simulate

VARIANTS = ("b-material", "b-both", "c-lubricant")


@pytest.fixture(scope="module")
def few(study):
    """The study of the paper with three of its variants, and the one that is damped more."""
    return replace(study, plan=study.plan.model_copy(update={"variants": VARIANTS}))


@pytest.fixture(scope="module")
def found(few, tmp_path_factory):
    runs = {
        variant.name: classify([few.pair.problem(variant, nu) for nu in nus])
        for variant, nus in few.plan.frequencies()
    }
    path = tmp_path_factory.mktemp("long_runs") / "attractors.nc"
    files.write(path, table(few, runs), few, "long-run motion of the cases")
    return open_dataset(path)


def test_each_case_has_its_kind_and_no_other_cell_has_one(found, few):
    kind = found["kind"]
    assert kind.attrs["flag_meanings"].split()[3] == "quasi_periodic"
    assert kind.attrs["flag_values"].tolist() == list(range(len(FLAGS)))
    for variant, nus in few.plan.frequencies():
        there = np.isin(found["nu"], nus)
        assert ((kind.sel(variant=variant.name) > 0) == there).all()
        for name in ("periods", "settling_periods", "y_max"):
            assert found[name].sel(variant=variant.name)[~there].isnull().all()
    no_orbit = found["periods"] == 0
    assert no_orbit.any() and found["y_max_rel"].where(no_orbit).isnull().all()


def test_a_case_that_has_settled_repeats_the_extremes_of_its_orbit(found, few):
    """Each run lasts 80 revolutions and keeps the last 12, which are 252 mesh periods."""
    pair = few.pair.replace(revolutions=80, kept_revolutions=12)
    for variant, nus in few.plan.frequencies():
        own = found.sel(variant=variant.name, nu=list(nus[::20]))
        settled = own.isel(nu=np.flatnonzero(own["settling_periods"] < 1000))
        runs = [pair.problem(variant, float(nu)) for nu in settled["nu"].values]
        assert len(runs) >= 5
        responses = simulate(runs, estimate_errors=False)
        for name in ("y_max", "y_min"):
            simulated = [getattr(response, name) for response in responses]
            assert settled[f"{name}_rel"].values == pytest.approx(simulated, abs=2e-3)
            in_mm = settled[f"{name}_rel"].values * pair.static_deflection
            assert settled[name].values == pytest.approx(in_mm, rel=1e-12)


def test_the_report_says_how_many_cases_settle_within_five_revolutions(found, few):
    """The row of c-• is that of the report; □ and × are represented by their slowest variants."""
    material, both, lubricant = shares(found, few.pair.revolutions * few.pair.teeth_3)
    assert (material.name, both.name, lubricant.name) == ("all □", "all ×", "c-lubricant")
    for row, last in ((material, 40), (both, 25)):
        assert row.kinds["period 1"] == row.in_time == 100.0
        assert row.last == last
    assert lubricant.kinds["period 1"] == pytest.approx(59.8, abs=1.0)
    assert lubricant.kinds["longer"] == pytest.approx(10.4, abs=1.0)
    assert lubricant.kinds["moving"] == pytest.approx(29.9, abs=1.0)
    moving = found["nu"].values[found["kind"].sel(variant="c-lubricant") == FLAGS.index("moving")]
    assert ((moving < 0.8) | (moving > 1.1)).all()
    assert lubricant.in_time == pytest.approx(59.3, abs=1.0)
    assert lubricant.last > 1000
    alone = ("periodic", "neutral", "quasi-periodic", "chaotic", "moving", "lost")
    assert sum(lubricant.kinds[kind] for kind in alone) == pytest.approx(100.0)
