"""The configuration of the inference, and the messages about mistakes in it."""

from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.identification.settings import Range, load_settings

SETTINGS = paths.CONFIG / "identify.yaml"


@pytest.fixture
def stated(root):
    return yaml.safe_load((root / SETTINGS).read_text(encoding="utf-8"))


def written(folder: Path, settings: dict) -> Path:
    path = folder / "identify.yaml"
    path.write_text(yaml.safe_dump(settings), encoding="utf-8")
    return path


def test_the_plausible_space_is_sampled_as_asked(root):
    settings = load_settings(root / SETTINGS)
    survey = settings.designs["survey"]
    assert survey.points >= 4096
    assert survey.around is None
    assert set(survey.vary) >= {
        *("backlash", "damping_length", "body_mass", "bearing_stiffness"),
        *("bearing_damping_ratio", "friction_coefficient"),
        *("initial_phase", "initial_velocity", "kind"),
    }


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s["ranges"]["backlash"].update(low=20), "ranges.backlash"),
        (lambda s: s["ranges"]["backlash"].update(low=0), "log scale"),
        (lambda s: s["ranges"]["backlash"].update(hihg=3), "hihg"),
        (lambda s: s["designs"]["survey"].update(points=1000), "power of 2"),
        (lambda s: s["designs"]["survey"]["vary"].append("colour"), "unknown factor 'colour'"),
        (lambda s: s["designs"]["near"].update(around="far"), "no design 'far'"),
        (lambda s: s["designs"]["near"].update(around="near"), "near around near; allowed"),
        (
            lambda s: s["designs"]["near"].update(around="nearer"),
            r"designs\.near\.around: .* circle",
        ),
        (lambda s: s["designs"]["nearer"].update(around="survey"), "'survey', as in near; allowed"),
        (
            lambda s: s["designs"]["near"]["vary"].remove("kind"),
            r"designs\.near\.vary.* of survey:",
        ),
        (
            lambda s: s["designs"]["near"]["vary"].reverse(),
            r"designs\.near\.vary.*found kind, init",
        ),
        (lambda s: s["designs"]["near"].update(fixed={"eccentricity_2": 1}), "eccentricity_2 = 1"),
        (lambda s: s["designs"]["run_out"].update(fixed={"kind": "sideways"}), "fixed.kind"),
        (lambda s: s["ranges"].pop("backlash"), "ranges.backlash"),
    ],
)
def test_a_mistake_in_the_settings_is_reported_in_one_line(tmp_path, stated, change, said):
    change(stated)
    with pytest.raises(InputError, match=said) as caught:
        load_settings(written(tmp_path, stated))
    assert "\n" not in str(caught.value)


def test_what_decides_the_samples_is_in_their_digest(tmp_path, stated):
    before = load_settings(written(tmp_path, stated)).sampling("near")
    stated["ranges"]["backlash"]["reason"] = "another reason"
    assert load_settings(written(tmp_path, stated)).sampling("near") == before
    stated["designs"]["survey"]["seed"] += 1
    assert load_settings(written(tmp_path, stated)).sampling("near") != before


@given(st.floats(0, 1), st.sampled_from(["linear", "log"]))
def test_a_range_leads_there_and_back(place, scale):
    bounds = Range(low=0.5, high=8.0, scale=scale, reason="a test")
    assert bounds.unit(bounds.value(place)) == pytest.approx(place, abs=1e-12)
    assert 0.5 * (1 - 1e-12) <= bounds.value(place) <= 8.0 * (1 + 1e-12)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)
PLACES = st.sampled_from(
    [("ranges",), ("ranges", "backlash"), ("ranges", "backlash", "low"),
     ("ranges", "backlash", "high"), ("ranges", "backlash", "least"), ("designs",),
     ("designs", "near"), ("designs", "near", "around"), ("designs", "survey", "points"),
     ("designs", "survey", "vary"), ("designs", "run_out", "fixed"), ("wordings",), ("together",)]
)  # fmt: skip


@settings(max_examples=40)
@given(place=PLACES, value=JSON)
def test_any_value_in_the_settings_is_read_or_an_input_error_of_one_line(
    root, tmp_path_factory, place, value
):
    stated = yaml.safe_load((root / SETTINGS).read_text(encoding="utf-8"))
    inside = stated
    for key in place[:-1]:
        inside = inside[key]
    inside[place[-1]] = value
    try:
        load_settings(written(tmp_path_factory.getbasetemp(), stated))
    except InputError as error:
        assert len(str(error).splitlines()) == 1
