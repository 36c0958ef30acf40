"""Figures: what they show is what the data hold, in the paper's colours, in the same bytes."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import imread

from gearmesh.data.datasets import open_dataset
from gearmesh.data.paths import FIGURE_NAMES, Places
from gearmesh.errors import InputError
from gearmesh.reproduction.figures import (
    canvas,
    fig1,
    fig2,
    fig3,
    fig4,
    fig5,
    fig6,
    fig7,
    orbit,
    palette,
)
from gearmesh.reproduction.frequencies import CROSSING, FIG_4

PLACES = Places("smoke")


@pytest.fixture(scope="module")
def resonance(small_run):
    return open_dataset(small_run / PLACES.resonance)


@pytest.fixture(scope="module")
def bifurcation(small_run):
    return open_dataset(small_run / PLACES.bifurcation)


@pytest.fixture(scope="module")
def courses(small_run, small_study):
    wanted = ("c-lubricant", "c-material", "c-material-5x")
    return orbit.read_time_courses(small_run / PLACES.cases, small_study.time_courses, *wanted)


@pytest.fixture(scope="module")
def draw(resonance, bifurcation, courses):
    material, strong, lubricant = (
        orbit.by_nu(courses, name) for name in ("c-material", "c-material-5x", "c-lubricant")
    )
    return {
        "fig1": fig1.draw,
        "fig2": lambda: fig2.draw(resonance),
        "fig3": lambda: fig3.draw(bifurcation),
        "fig4": lambda: fig4.draw(lubricant),
        "fig5": lambda: fig5.draw(material),
        "fig6": lambda: fig6.draw(material, strong),
        "fig7": lambda: fig7.draw(material[CROSSING], strong[CROSSING]),
    }


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(mpl.text.Text)]


def points(axes) -> np.ndarray:
    """Return all points of the lines of `axes`, shape (n, 2), without those that are not drawn."""
    drawn = [line.get_xydata() for line in axes.lines if line.get_marker() not in ("None", None)]
    joined = np.concatenate(drawn)
    return joined[np.isfinite(joined).all(axis=1)]


def test_a_figure_has_the_same_bytes_each_time_whatever_the_settings(tmp_path):
    """Those that a notebook draws are compared by tests/workflow/test_notebooks.py."""
    first = canvas.save(fig1.draw(), tmp_path / "first")
    with mpl.rc_context({"font.size": 30, "svg.hashsalt": "other", "savefig.dpi": 20}):
        second = canvas.save(fig1.draw(), tmp_path / "second")
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
    assert imread(first[0]).shape[1] >= 200 * canvas.WIDTH
    assert b"<dc:date>" not in first[1].read_bytes()


@pytest.mark.parametrize("name", FIGURE_NAMES)
def test_a_figure_is_as_wide_as_a_page(name, draw):
    assert draw[name]().get_size_inches()[0] == canvas.WIDTH


def test_fig2_shows_every_extreme_of_every_course_and_joins_none(resonance):
    figure = fig2.draw(resonance)
    shown = points(figure.axes[0])
    for name in ("a-conservative", "b-material", "b-both", "b-lubricant"):
        for variable in ("y_max_rel", "y_min_rel"):
            course = resonance[variable].sel(variant=name)
            for nu, y in zip(course["nu"].values, course.values, strict=True):
                assert (np.abs(shown - (nu, y)).max(axis=1) == 0).any()
    courses = [line for line in figure.axes[0].lines if line.get_marker() != "None"]
    assert all(line.get_linestyle() == "None" for line in courses)


def test_fig3_shows_every_extremum(bifurcation):
    figure = fig3.draw(bifurcation)
    panels = zip(
        figure.axes[:6],
        [f"{letter}-{kind}" for kind in ("lubricant", "material") for letter in "cdh"],
        strict=True,
    )
    for axes, name in panels:
        y = bifurcation["extremum_y_rel"].sel(variant=name).values
        low, high = axes.get_ylim()
        assert len(points(axes)) == np.isfinite(y).sum()
        assert low < np.nanmin(y)
        assert np.nanmax(y) < high


def test_fig3_enlarges_detail_x(bifurcation):
    figure = fig3.draw(bifurcation)
    (detail,) = figure.axes[3].child_axes
    near = bifurcation["extremum_y_rel"].sel(variant="c-material", nu=slice(*fig3.DETAIL_X))
    low, high = detail.get_ylim()
    assert detail.get_xlim() == fig3.DETAIL_X
    assert ((points(detail)[:, 1] > low) & (points(detail)[:, 1] < high)).sum() == (
        (near.values > low) & (near.values < high)
    ).sum()
    assert high > float(near.max())


def test_fig4_shades_exactly_the_contact_loss(courses):
    figure = fig4.draw(orbit.by_nu(courses, "c-lubricant"))
    course = orbit.last_periods(courses["c-lubricant", 1.05], 21)
    loss, inverse = figure.axes[len(FIG_4) + 1].collections
    lost = course["period"].values[course["regime"].values == 0]
    stretches = [path.get_extents() for path in loss.get_paths()]
    assert all(any(box.x0 <= t <= box.x1 for box in stretches) for t in lost)
    share = sum(box.width for box in stretches) / 21
    assert share == pytest.approx(
        float(courses["c-lubricant", 1.05]["contact_loss_fraction"]), abs=0.02
    )
    assert not inverse.get_paths()


def test_fig5_keeps_orbits_apart_and_tells_loops(courses):
    material = orbit.by_nu(courses, "c-material")
    figure = fig5.draw(material)
    axes = figure.axes[0]
    orbits = {
        round(float(line.get_data_3d()[0][0]), 4): line.get_color()
        for line in axes.lines
        if np.ptp(line.get_data_3d()[0]) == 0
    }
    assert np.diff(sorted(orbits)).min() > fig5.SPACING - 1e-9
    for nu, colour in orbits.items():
        has_loop = float(material[nu]["turning_points_per_period"]) > 2
        assert (colour == palette.BLUE) == has_loop


def test_fig6_shows_only_its_range(courses):
    figure = fig6.draw(orbit.by_nu(courses, "c-material"), orbit.by_nu(courses, "c-material-5x"))
    shown = {float(line.get_data_3d()[0][0]) for line in figure.axes[0].lines}
    assert shown == {nu for name, nu in courses if name == "c-material" and nu <= 0.8}


def test_fig7_shows_two_periods_of_all_six_courses(courses):
    pair = [courses[name, CROSSING] for name in ("c-material", "c-material-5x")]
    figure = fig7.draw(*pair)
    for axes, (name, divisor, _) in zip(figure.axes[2:], fig7.ROWS, strict=True):
        lines = [line for line in axes.lines if len(line.get_xdata()) == 512]
        for line, case in zip(lines, pair, strict=True):
            assert np.array_equal(line.get_ydata(), case[name].values[-512:] / divisor)


@pytest.mark.parametrize(
    ("limits", "expected"),
    [
        ((0.5, 2.0), []),
        ((-1.0, 2.0), [(-1.0, 0.0, palette.CONTACT_LOSS)]),
        ((-6.0, 2.0), [(-4.0, 0.0, palette.CONTACT_LOSS), (-6.0, -4.0, palette.INVERSE_MESH)]),
    ],
)
@pytest.mark.parametrize("along", ["x", "y"])
def test_regions_are_shaded_where_they_are(limits, expected, along):
    axes = Figure().subplots()
    axes.set(**{f"{along}lim": limits})
    canvas.shade_regions(axes, backlash=4.0, along=along)
    found = []
    for patch in axes.patches:
        box = patch.get_extents().transformed(axes.transData.inverted())
        ends = (box.x0, box.x1) if along == "x" else (box.y0, box.y1)
        found.append((*np.round(ends, 9), patch.get_facecolor()[:3]))
    assert found == [(low, high, to_rgb(colour)) for low, high, colour in expected]
    assert (axes.get_xlim() if along == "x" else axes.get_ylim()) == limits


def test_regions_have_the_colours_of_the_paper_and_differ_in_grey():
    white, yellow, red = (
        np.array(to_rgb(colour))
        for colour in (palette.NORMAL_MESH, palette.CONTACT_LOSS, palette.INVERSE_MESH)
    )
    assert np.array_equal(white, (1, 1, 1))
    assert min(yellow[:2]) > yellow[2] + 0.2
    assert red[0] > max(red[1:]) + 0.2
    grey = [float(colour @ (0.2126, 0.7152, 0.0722)) for colour in (white, yellow, red)]
    assert grey[0] - grey[1] > 0.04
    assert grey[1] - grey[2] > 0.1


def test_courses_differ_in_shape_and_the_dampings_in_lightness():
    looks = {(c.marker, c.open, c.colour) for c in palette.LOOKS.values()}
    shapes = {(c.marker, c.open) for c in palette.LOOKS.values()}
    assert len(looks) == len(shapes) == len({c.symbol for c in palette.LOOKS.values()}) == 4
    grey = [np.dot(to_rgb(c), (0.2126, 0.7152, 0.0722)) for c in (palette.BLUE, palette.RED)]
    assert abs(grey[0] - grey[1]) > 0.1


@pytest.mark.parametrize("scale", ["linear", "symlog"])
def test_micrometres_stand_where_the_static_deflections_do(scale):
    figure = Figure()
    axes = figure.subplots()
    if scale == "symlog":
        axes.set_yscale("symlog", linthresh=4.0, linscale=1.6)
    axes.set_ylim(-20.0, 30.0)
    right = canvas.micrometre_axis(axes, static_deflection=0.01)
    figure.draw_without_rendering()
    for y in (-15.0, -4.0, 0.0, 2.0, 25.0):
        here = axes.transData.transform((0.5, y))[1]
        there = right.transData.transform((0.5, 10.0 * y))[1]
        assert here == pytest.approx(there)


@pytest.mark.parametrize(
    ("stiffness", "up", "down"),
    [([4, 4, 2, 2, 4, 4], [4], [2]), ([2, 2, 4, 4, 2, 2, 4, 4], [2, 6], [0, 4])],
)
def test_switches_are_where_the_stiffness_steps_also_between_periods(stiffness, up, down):
    found = orbit.switches(xr.Dataset({"stiffness": ("sample", np.array(stiffness, float))}))
    assert [places.tolist() for places in found] == [up, down]


@pytest.mark.parametrize("periods", [1, 2, 21])
def test_every_period_has_both_switches(courses, periods):
    for case in courses.values():
        up, down = orbit.switches(orbit.last_periods(case, periods))
        assert len(up) == len(down) == periods


def test_last_periods_end_with_the_run(courses):
    course = orbit.last_periods(courses["c-material", 0.61], 2)
    assert course.sizes == {"sample": 512}
    assert course["period"].values[0] == pytest.approx(103.0)
    assert course["period"].values[-1] == pytest.approx(105.0 - 1 / 256)


def test_scales_come_from_the_parameters_of_the_file(courses, small_study):
    found = orbit.scale(courses["c-material", 0.61])
    pair = small_study.pair
    assert found.static_deflection == pair.static_deflection
    assert found.backlash == pair.backlash / pair.static_deflection
    assert (found.kept_periods, found.damping) == (21, pair.damping)


@pytest.mark.parametrize("module", [fig2, fig3])
def test_a_variant_that_the_study_lacks_leaves_its_panel_empty(module, resonance, bifurcation):
    whole = {fig2: resonance, fig3: bifurcation}[module]
    part = whole.sel(variant=["a-conservative", "c-material", "e-both"])
    assert canvas.NOT_IN_STUDY in texts(module.draw(part))


def test_a_course_that_failed_throughout_leaves_its_panel_empty(bifurcation):
    failed = bifurcation.copy(deep=True)
    failed["extremum_y_rel"].loc[{"variant": "d-lubricant"}] = np.nan
    assert texts(fig3.draw(failed)).count(canvas.NOT_IN_STUDY) == 1


@pytest.mark.parametrize(
    "figure",
    [
        lambda: fig4.draw({}),
        lambda: fig5.draw({}),
        lambda: fig6.draw({}, {}),
        lambda: fig7.draw(None, None),
    ],
)
def test_a_figure_without_cases_says_so(figure):
    assert texts(figure()) == [canvas.NOT_IN_STUDY]


def test_fig4_draws_the_tunings_that_there_are(courses):
    part = {1.05: courses["c-lubricant", 1.05]}
    titles = [axes.get_title(loc="left") for axes in fig4.draw(part).axes]
    assert sum("1.05" in title for title in titles) == 1
    assert not any("0.60" in title or "1.20" in title for title in titles)


def test_a_damaged_case_is_named(small_run, small_study, tmp_path):
    source = small_run / PLACES.case("c-lubricant", 0.6)
    damaged = tmp_path / Path(source).relative_to(small_run / PLACES.cases)
    damaged.parent.mkdir()
    damaged.write_bytes(source.read_bytes()[:-100])
    with pytest.raises(InputError, match=r"nu-0\.6000\.nc"):
        orbit.read_time_courses(tmp_path, {"c-lubricant": [0.6]}, "c-lubricant")
