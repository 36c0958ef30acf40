"""The explorer: its solver agrees with the library, and every control does what it says."""

import csv
import io
import itertools
import xml.etree.ElementTree as ElementTree
from urllib.parse import parse_qs

import numpy as np
import pytest
from PIL import Image

from gearmesh.data.datasets import open_dataset
from gearmesh.model.variants import VARIANTS, variant
from gearmesh.report.explorer.controls import CONTROLS, shown
from gearmesh.solvers.simulation import simulate

AGREEMENT = 1e-6
"""How far the page may be from the library, in y_st and y_st Ω_s."""

# A run in the page; 'changed' holds parameters in the units that the page shows.
RUN = """
([variant, nu, changed]) => {
  const { problemOf, simulate, view, pairOf } = window.gearmesh;
  view.changed = changed;
  const run = simulate(problemOf(pairOf(), variant, nu), 32);
  view.changed = {};
  return {
    status: run.status, extremes: [run.yMax, run.yMin], strobes: [...run.strobes],
    extrema: run.extrema.map(({ y }) => y), times: run.extrema.map(({ time }) => time),
    samples: [[...run.y], [...run.v], [...run.a]], loss: run.contactLossFraction,
  };
}
"""

CHANGES = (
    {"contact_ratio": 1.3, "stiffness_ratio": 0.75},
    {"backlash": 1.5, "damping": 1.2},
    {"friction_coefficient": 0.2, "initial_phase": 0.61},
    {"body_mass": 20, "bearing_stiffness": 2e6, "bearing_damping_ratio": 0.1},
    {"damping_length": 0.2, "initial_displacement": -1.5, "initial_velocity": 0.7},
    {"contact_ratio": 1, "revolutions": 3},
    {"contact_ratio": 2, "friction_coefficient": 0},
)
"""Changed parameters, in the units that the page shows."""


def changed_pair(pair, changes):
    """Return the pair that the page makes of changed parameters."""
    factors = {row.control.name: row.factor for row in shown(pair)}
    units = {row.name: row.unit for row in pair.parameters}
    stated = {
        name: value if units[name] == "1" else f"{value * factors[name]!r} {units[name]}"
        for name, value in changes.items()
    }
    return pair.replace(**stated)


@pytest.fixture
def explorer(open_tab, report):
    return open_tab().open(report / "explorer.html")


def test_more_than_forty_runs_of_all_variants_agree_with_the_library(explorer, pair):
    """Runs that amplify errors are left out: there the library itself has no digits to compare."""
    cases = [(name, nu, {}) for name, nu in itertools.product(VARIANTS, (0.62, 0.84, 1.06))]
    cases += [(name, 0.9, changes) for name in ("g-both", "c-lubricant") for changes in CHANGES]
    pairs = [changed_pair(pair, changes) for *_, changes in cases]
    problems = [p.problem(variant(name), nu) for p, (name, nu, _) in zip(pairs, cases, strict=True)]
    found = simulate(problems, pair.tolerance, samples_per_period=32)
    compared = [i for i, response in enumerate(found) if not response.sensitive]
    assert len(compared) >= 40
    assert {cases[i][0] for i in compared} == {*VARIANTS}
    for i in compared:
        response, run = found[i], explorer.evaluate(RUN, list(cases[i]))
        strobes = np.reshape(run["strobes"], (-1, 2)).T
        there = response.samples
        for name, here, expected in (
            ("extremes", run["extremes"], (response.y_max, response.y_min)),
            ("stroboscopic points", strobes, (response.strobe_y, response.strobe_v)),
            ("extrema", run["extrema"], response.extremum_y),
            ("samples", run["samples"][:2], (there.y, there.v)),
            ("contact loss", run["loss"], response.contact_loss_fraction),
        ):
            np.testing.assert_allclose(
                here, expected, rtol=0, atol=AGREEMENT, err_msg=f"{cases[i]}: {name}"
            )


def test_the_diagram_holds_the_dataset(explorer, smoke):
    bifurcation = open_dataset(smoke.study / "datasets" / "bifurcation.nc")
    for name in ("a-conservative", "c-lubricant", "c-material-5x"):
        dots = explorer.evaluate("(name) => window.gearmesh.studyDots(name)", name)
        curve = bifurcation.sel(variant=name)["extremum_y_rel"]
        y = curve.values[curve.notnull().values]
        nu = np.broadcast_to(curve["nu"].values[:, None], curve.shape)[curve.notnull().values]
        assert dots["nu"] == nu.tolist()
        assert dots["y"] == y.astype("f4").astype(float).tolist()


def test_every_variant_can_be_chosen_and_agrees_with_its_case(explorer, smoke):
    resonance = open_dataset(smoke.study / "datasets" / "resonance.nc")
    explorer.fill("#nu-field", "0.8")
    explorer.press("#nu-field", "Enter")
    names = [str(name) for name in resonance["variant"].values]
    assert (
        explorer.locator("#variant option").evaluate_all("all => all.map((o) => o.value)") == names
    )
    for name in names:
        explorer.select_option("#variant", name)
        case = resonance.sel(variant=name, nu=0.8)
        explorer.wait_for_function("(v) => location.hash.includes(`variant=${v}&`)", arg=name)
        told = explorer.inner_text("#read-study")
        if case["sensitive"] == 1:
            assert "amplifies errors" in told
        else:
            assert told == "agrees with the dataset"
            words = explorer.inner_text("#read-y-max").split()[0].replace("−", "-")
            assert float(words) == pytest.approx(float(case["y_max_rel"]), rel=1e-6)


def test_every_slider_moves_its_parameter_by_keyboard(explorer, pair):
    """Three presses of an arrow key; the run is then that of the library with this parameter."""
    explorer.select_option("#variant", "g-both")
    moved, runs = [], []
    for control in CONTROLS:
        explorer.focus(f"#slide-{control.name}")
        for _ in range(3):
            explorer.keyboard.press("ArrowRight")
        explorer.wait_for_function(
            "(name) => new URLSearchParams(location.hash.slice(1)).has(name)", arg=control.name
        )
        changes = explorer.evaluate("window.gearmesh.view.changed")
        assert [*changes] == [control.name]
        field = explorer.input_value(f"[data-parameter={control.name}]")
        assert float(field) == pytest.approx(changes[control.name], rel=1e-4)
        moved.append(changes)
        runs.append(explorer.evaluate("[gearmesh.result().yMax, gearmesh.result().yMin]"))
        explorer.click("#reset")
    nu = explorer.evaluate("window.gearmesh.view.nu")
    problems = [changed_pair(pair, changes).problem(variant("g-both"), nu) for changes in moved]
    for changes, here, there in zip(moved, runs, simulate(problems, pair.tolerance), strict=True):
        np.testing.assert_allclose(
            here, (there.y_max, there.y_min), rtol=0, atol=AGREEMENT, err_msg=str(changes)
        )


def test_a_field_takes_any_allowed_number_and_no_other(explorer):
    backlash = "[data-parameter=backlash]"
    for typed, kept in (("33", "33"), ("-5", "0.0001"), ("", "0.0001")):
        explorer.fill(backlash, typed)
        explorer.press(backlash, "Enter")
        assert explorer.input_value(backlash) == kept
    for typed, kept in (("-5", 0.05), ("1e9", 5), ("", 5), ("0.77125", 0.77125)):
        explorer.fill("#nu-field", typed)
        explorer.press("#nu-field", "Enter")
        assert explorer.evaluate("gearmesh.view.nu") == kept
        assert float(explorer.input_value("#nu-field")) == kept
    revolutions = "[data-parameter=revolutions]"
    explorer.fill(revolutions, "10000")
    explorer.press(revolutions, "Enter")
    assert explorer.input_value(revolutions) == "400"


def test_the_picture_answers_to_pointer_keys_and_touch(explorer):
    diagram = explorer.locator("#diagram").bounding_box()
    middle = diagram["y"] + diagram["height"] / 2
    explorer.mouse.move(diagram["x"] + 0.5 * diagram["width"], middle)
    explorer.mouse.down()
    for share in (0.55, 0.6, 0.65):
        explorer.mouse.move(diagram["x"] + share * diagram["width"], middle)
    explorer.mouse.up()
    dragged = explorer.evaluate("gearmesh.view.nu")
    assert 0.9 < dragged < 1.05
    explorer.focus("#diagram")
    explorer.keyboard.press("ArrowLeft")
    assert explorer.evaluate("gearmesh.view.nu") == pytest.approx(dragged - 0.001)
    explorer.focus("#course")
    explorer.keyboard.press("ArrowRight")
    explorer.wait_for_function("document.getElementById('hover').textContent.includes('t/T = ')")
    course = explorer.locator("#course").bounding_box()
    explorer.mouse.move(course["x"] + 0.5 * course["width"], course["y"] + 40)
    explorer.wait_for_function("document.getElementById('hover').textContent.includes('t/T = 102')")


def test_hovering_tells_the_numbers_of_a_dot(explorer, smoke):
    bifurcation = open_dataset(smoke.study / "datasets" / "bifurcation.nc")
    explorer.select_option("#variant", "c-material")
    y = bifurcation.sel(variant="c-material").sel(nu=0.9, method="nearest")["extremum_y_rel"]
    top = float(y.max())
    # The diagram of the variant is drawn in the next frame.
    explorer.evaluate(
        "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )
    place = explorer.evaluate(
        "([nu, y]) => { const b = document.getElementById('diagram').getBoundingClientRect();"
        " const f = gearmesh.diagram.frame; return [b.left + f.toX(nu), b.top + f.toY(y)]; }",
        [0.9, top],
    )
    explorer.mouse.move(*place)
    explorer.wait_for_function("document.getElementById('hover').textContent.includes('maximum')")
    words = explorer.inner_text("#hover").replace("−", "-")
    assert "νₛ = 0.9\n" in words
    assert float(words.split("y = ")[1].split()[0]) == pytest.approx(top, abs=1e-5)


def test_a_link_shows_the_view_again(open_tab, report, explorer):
    explorer.select_option("#variant", "d-lubricant")
    explorer.select_option("#beside", "c-material")
    explorer.select_option("#periods", "21")
    explorer.fill("[data-parameter=backlash]", "2.5")
    explorer.press("[data-parameter=backlash]", "Enter")
    explorer.wait_for_function("location.hash.includes('backlash=2.5')")
    hash_ = explorer.evaluate("location.hash")
    assert parse_qs(hash_[1:])["beside"] == ["c-material"]
    other = open_tab().open(report / "explorer.html", hash_)
    same = "[gearmesh.view, [...gearmesh.result().strobes]]"
    assert other.evaluate(same) == explorer.evaluate(same)
    assert other.input_value("#periods") == "21"


def test_what_is_not_in_a_link_does_no_harm(open_tab, report):
    page = open_tab().open(
        report / "explorer.html", "#variant=x-<b>&nu=nan&backlash=oops&periods=7&__proto__=1&nu=99"
    )
    assert page.evaluate("gearmesh.view.nu") == 5
    assert page.evaluate("gearmesh.view.changed") == {}


def test_the_tour_leads_through_its_views(explorer):
    stops = explorer.locator("[data-stop]")
    seen = set()
    for i in range(stops.count()):
        stops.nth(i).click()
        explorer.wait_for_selector(f"#stop-{i + 1}:visible")
        assert stops.nth(i).get_attribute("aria-current") == "step"
        seen.add(explorer.evaluate("gearmesh.result().yMax"))
    assert len(seen) == stops.count()


def test_a_stop_is_shown_however_soon_after_another_it_is_chosen(explorer):
    """The address is written with a delay; what was chosen meanwhile must not be lost."""
    shown = explorer.evaluate(
        """async () => {
            const links = [...document.querySelectorAll("[data-stop]")], lost = [];
            for (let wait = 100; wait < 200; wait += 4) {
                links[0].click();
                await new Promise(done => setTimeout(done, wait));
                links[2].click();
                await new Promise(done => setTimeout(done, 250));
                if (document.getElementById("stop-3").hidden) lost.push(wait);
            }
            return lost;
        }"""
    )
    assert shown == []


def test_the_tour_says_what_the_runs_show(explorer):
    """Each number in its texts: the motions at 0.75 and 0.79, and where the jump lies."""
    run = f"([nu, changes]) => ({RUN})(['c-lubricant', nu, changes])"

    def show(nu, **changes):
        found = explorer.evaluate(run, [nu, changes])
        return found["extremes"][0], found["loss"]

    assert show(0.75)[1] == pytest.approx(0.03, abs=0.005)
    assert 0.48 < show(0.79)[1] < 0.55
    assert show(0.75, initial_displacement=-1)[0] > 3
    for start, jump in (
        ({}, 0.77),
        ({"initial_phase": 0}, 0.745),
        ({"initial_displacement": -1}, 0.706),
    ):
        assert show(jump - 0.005, **start)[0] < 3 < show(jump + 0.0025, **start)[0]
    points = explorer.evaluate("gearmesh.studySpecialPoints('c-lubricant')")
    told = [(point["kind"], round(point["nu"], 3)) for point in points]
    assert {("fold", 0.706), ("grazing_front", 0.791), ("fold", 0.805)} <= {*told}


def test_changed_parameters_are_swept(explorer):
    explorer.fill("[data-parameter=damping]", "8")
    explorer.press("[data-parameter=damping]", "Enter")
    explorer.wait_for_function("gearmesh.sweep.active && !gearmesh.sweep.waiting.length")
    assert explorer.evaluate("new Set(gearmesh.sweep.dots.nu).size") == 161
    explorer.click("#reset")
    explorer.wait_for_function("!gearmesh.sweep.active")


def download(page, button) -> bytes:
    with page.expect_download() as event:
        page.click(button)
    with open(event.value.path(), "rb") as file:
        return file.read()


def test_numbers_and_pictures_can_be_saved(explorer):
    lines = download(explorer, "#save-course").decode().splitlines()
    rows = [*csv.DictReader(line for line in lines if not line.startswith("#"))]
    assert any(line == "# variant: c-lubricant" for line in lines)
    shown_y = explorer.evaluate("[...gearmesh.result().y]")
    assert [float(row["y_rel"]) for row in rows] == shown_y
    diagram = download(explorer, "#save-diagram").decode()
    assert diagram.count("maximum") == explorer.evaluate(
        "gearmesh.studyDots('c-lubricant').maximum.filter(Boolean).length"
    )
    svg = download(explorer, "#save-svg")
    texts = [text.text for text in ElementTree.fromstring(svg).findall(".//{*}text")]
    assert {"mesh frequency νₛ", "A", "B", "y′"} <= {*texts}
    picture = Image.open(io.BytesIO(download(explorer, "#save-png"))).convert("RGB")
    assert picture.size == (2400, 1860)
    assert len(picture.getcolors(1 << 24)) > 50
