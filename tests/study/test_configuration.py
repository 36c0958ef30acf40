"""Configurations: what they mean, and what is said of wrong ones."""

import string

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS
from gearmesh.study.cases import Study
from gearmesh.study.frequencies import read_nu
from gearmesh.study.loading import load_study

fuzz = settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@pytest.fixture
def paper(root):
    return root / paths.PAPER


@pytest.fixture
def write(tmp_path, paper):
    """Return a function that writes a file beside a copy of the paper's configuration."""
    (tmp_path / "paper.yaml").write_bytes(paper.read_bytes())

    def write(text, name="study.yaml"):
        file = tmp_path / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    return write


def test_the_paper_s_study(study):
    cases = study.cases
    grid = {case.nu for case in cases if case.variant.name == "d-both"}
    assert len(grid) == 241
    assert {case.variant.name for case in cases} == {*VARIANTS, "c-material-5x"}
    assert {0.6, 0.66, 1.05, 1.2} <= grid
    assert len(set(cases)) == len(cases) >= 22 * 241 + 81
    courses = {case.variant.name for case in cases if case.time_course}
    assert courses == {"c-lubricant", "c-material", "c-material-5x"}


def test_smoke_is_the_same_study_with_fewer_frequencies(root, study):
    smoke = load_study(root / paths.SMOKE)
    assert smoke.parameters == study.pair
    assert smoke.reasons == study.reasons
    assert smoke.study.variants == study.study.variants
    assert 0 < len(smoke.cases()) < len(study.cases) / 10


def test_a_time_course_off_the_grid_is_a_case(paper):
    study = load_study(paper, ["study.time_courses={b-both: [0.6051]}"])
    [case] = [case for case in study.cases if case.time_course]
    assert (case.variant.name, case.nu) == ("b-both", 0.6051)
    assert sum(c.nu == case.nu for c in study.cases) == 1


def test_adding_frequencies_keeps_the_files_that_exist(paper):
    def files(*overrides):
        cases = load_study(paper, overrides).cases()
        return {paths.case_file(case.variant.name, case.nu) for case in cases}

    assert files() < files("study.nu.values=[0.66125, 0.7001]")


@pytest.mark.parametrize(
    ("nu", "label"),
    [(0.66, "0.6600"), (0.6025, "0.6025"), (0.60125, "0.60125"), (2.0, "2.0000"),
     (0.6000000001, "0.6000000001"), (10.0, "10.0000")],
)  # fmt: skip
def test_labels(nu, label):
    assert paths.nu_label(nu) == label


@given(st.floats(0.01, 10.0), st.floats(0.01, 10.0))
def test_labels_name_one_frequency(first, second):
    first, second = read_nu(first), read_nu(second)
    assert float(paths.nu_label(first)) == first
    assert (paths.nu_label(first) == paths.nu_label(second)) == (first == second)
    assert len(paths.nu_label(first).split(".")[1]) >= 4


@fuzz
@given(st.integers(100, 9000), st.integers(1, 5000), st.integers(0, 300))
def test_a_grid_holds_the_decimals_that_one_would_write(paper, start, step, count):
    stop = start + step * count
    grid = f"{{start: {start}e-4, stop: {stop}e-4, step: {step}e-4}}"
    overrides = [f"study.nu={grid}", "study.time_courses={}", "study.variants=[b-both]"]
    if stop > 100_000:
        with pytest.raises(InputError):
            load_study(paper, overrides)
        return
    expected = [float(f"{start + i * step}e-4") for i in range(count + 1)]
    assert list(load_study(paper, overrides).study.nu.all) == expected


def test_overrides_are_typed_like_the_file(paper):
    study = load_study(paper, ["assumed.backlash=55 um", "run.revolutions=9", "title=no"])
    assert study.backlash == 0.055
    assert study.revolutions == 9
    assert study.title == "no"
    assert study.reasons["backlash"] == "set on the command line"


def test_base_is_inherited_key_by_key(write):
    write("base: paper.yaml\nassumed: {backlash: 30 um}\nstudy: {strong_damping: null}", "a.yaml")
    file = write("base: a.yaml\nassumed: {module: 2 mm}\nstudy: {time_courses: {c-material-5x: }}")
    study = load_study(file)
    assert (study.backlash, study.module) == (0.03, 2.0)
    assert study.study.strong_damping is None


def test_a_dumped_study_is_the_same_study(write, study):
    """What a configuration means survives being written in other units and another order."""
    data = {
        **study.pair.texts(),
        "title": study.title,
        "reasons": study.reasons,
        "study": study.study.model_dump(mode="json", exclude_none=True),
    }
    file = write(yaml.safe_dump(data, allow_unicode=True, sort_keys=True))
    assert load_study(file) == study


MISTAKES = """
printed=5 | printed: found 5; allowed is a mapping
printed.contact_ratio=2.5 | printed.contact_ratio: found 2.5; out of range; allowed is 1 to 2
printed.contact_ratio=0.9 | found 0.9; out of range; allowed is 1 to 2
printed.contact_ratio=1,569 | found '1,569'; not a quantity; wanted is a plain number
printed.contact_ratio=.nan | found nan; not finite
printed.contact_ratio=.inf | found inf; not finite
printed.contact_ratio=1e999 | found inf; not finite
printed.contact_ratio= | found nothing; not a quantity
printed.contact-ratio=1.5 | printed.contact-ratio: unknown key (did you mean 'contact_ratio'?)
printed.stiffness_ratio=58.79 % of C_max | not a quantity
printed.stiffness_ratio=0 | out of range
printed.mesh_stiffness_max=400000 | found 400000; unit missing; wanted is a stiffness
printed.mesh_stiffness_max=4e5 N | unit 'N' is of another kind; wanted is a stiffness
printed.mesh_stiffness_max=4·10^5 N/mm | not a quantity
printed.reduced_mass=3.123 mm | found '3.123 mm'; unit 'mm' is of another kind; wanted is a mass
printed.reduced_mass=-3 kg | found '-3 kg'; out of range; allowed is 1e-06 to 1e+06 kg
printed.reduced_mass=3.123 kgs | unknown unit 'kgs'
printed.teeth=21.5 | found 21.5; allowed is a whole number
printed.teeth=twenty-one | not a quantity
printed.teeth=true | found True; not a quantity
printed.teeth=yes | found 'yes'; not a quantity
printed.teeth=[21, 21] | printed.teeth: found a list
printed.damping=3.95 | unit missing; wanted is a damping coefficient
printed.damping=3.95 N/mm | of another kind
printed.Damping=3.95 N s/mm | printed.Damping: unknown key (did you mean 'damping'?)
derived.pressure_angle=20 | unit missing; wanted is an angle
derived.pressure_angle=20 mm | of another kind
assumed.backlash=40um. | not a quantity
assumed.backlash=0 um | out of range
assumed.backlash={value: 40, unit: um} | found a mapping; not a quantity
assumed.backlash=40 um: 3 | found a mapping; not a quantity
assumed.backlsh=40 um | assumed.backlsh: unknown key (did you mean 'backlash'?)
assumed.backlash=*a | aliases (*) are not supported
assumed.backlash=!!python/object/apply:os.system [ls] | tags (!) are not supported
assumed.backlash=[40 um | expected ',' or ']'
assumed.body_mass=100 | unit missing; wanted is a mass
assumed.bearing_damping_ratio=3 | out of range; allowed is 0 to 1
assumed.friction_coefficient=-0.05 | found -0.05; out of range
assumed.eccentricity_angle=400 deg | out of range
assumed.initial_phase=90 deg | unit 'deg' where none belongs
assumed.stiffness_harmonics=2.5 | allowed is a whole number
assumed.profile_deviation=1 um | found '1 um'; allowed is a list
assumed.profile_deviation=[[1 um]] | missing
assumed.profile_deviation=[[1 um, 0 kg]] | of another kind
reasons=3 | reasons: found 3; allowed is a mapping
reasons.backlash= | reasons.backlash: found nothing; allowed is a text
reasons.backlash="" | reasons.backlash: found ''; allowed is one line
reasons.backlsh=none | reasons.backlsh: no assumed key of this name (did you mean 'backlash'?)
run.revolutions=0 | out of range
run.revolutions=1e9 | out of range
run.kept_revolutions=6 | run.kept_revolutions: found 6; allowed are at most the 5
run.samples_per_period=none | not a quantity
solver.tolerance=0 | out of range
solver.tolerance=1 | out of range
solver.tol=1e-8 | solver.tol: unknown key
study.nu=0.66 | study.nu: found 0.66; allowed is a mapping
study.nu.start=1.3 | study.nu.stop: found 1.2, below start; allowed is 1.3 to 10
study.nu.start= | study.nu.start: missing; a grid has start, stop and step
study.nu.start=-0.6 | out of range; allowed is 0.01 to 10
study.nu.start=1:30 | not a quantity
study.nu.step=0 | out of range
study.nu.step=-0.0025 | out of range
study.nu.step=1e-9 | study.nu.step: makes 600000001 frequencies; allowed are at most 200000
study.nu.step=2.5e-5 | study.nu: makes
study.nu.stp=0.01 | study.nu.stp: unknown key (did you mean
study.nu.values=0.7 | allowed is a list
study.nu.values=[0.601, x] | study.nu.values.1: found 'x'
study.nu.values=[0.601, 0.601] | study.nu.values: found 0.601 twice
study.nu.values=[0.6] | study.nu.values: found 0.6 twice, or on the grid too
study.variants=[c-lubicant] | found 'c-lubicant'; unknown variant (did you mean 'c-lubricant'?)
study.variants=[i-both] | study.variants.0: found 'i-both'; unknown variant
study.variants=c-material | found 'c-material'; allowed is a list of variants, or all
study.variants=[] | study.variants: found none
study.variants=[c-material, c-material] | study.variants: found c-material twice
study.variants=[3] | unknown variant
study.strong_damping=5 | found 5; allowed is a mapping
study.strong_damping.factor=1 | study.strong_damping.factor: found 1
study.strong_damping.factor=-5 | out of range
study.strong_damping.variant=a-conservative | allowed is a variant with damping
study.time_courses=0.6 | study.time_courses: found 0.6; allowed is a mapping
study.time_courses={c-materal: [0.6]} | study.time_courses.c-materal: this variant is not computed
study.time_courses.c-lubricant=0.6 | allowed is a list
study.time_courses.c-lubricant=[3.0] | found 3; allowed is 0.6 to 1.2
study.time_courses.c-lubricant=[0.6, 0.6] | found 0.6 twice
title= | title: found nothing; allowed is a text
title=5 | title: found 5; allowed is a text
titel=x | titel: unknown key (did you mean 'title'?)
base=other.yaml | base: unknown key
x | allowed is KEY=VALUE
=3 | allowed is KEY=VALUE
a..b=3 | allowed is KEY=VALUE
printed.teeth.number=3 | 'teeth' is no section
"""


@pytest.mark.parametrize("mistake", MISTAKES.strip().splitlines())
def test_a_wrong_value_is_told_in_one_line(paper, mistake):
    override, _, expected = mistake.partition(" | ")
    with pytest.raises(InputError) as caught:
        load_study(paper, [override])
    assert expected in str(caught.value)
    assert f"--set {override}" in str(caught.value)
    assert "\n" not in str(caught.value)


BAD_FILES = {
    "empty": (b"", "the file is empty"),
    "only a comment": (b"# nothing\n", "the file is empty"),
    "no mapping": (b"- 1\n- 2\n", "found no keys"),
    "a word": (b"gears", "found no keys"),
    "key twice": (b"base: paper.yaml\nstudy:\n  nu: {}\n  nu: {}\n", "line 4, column 3: key 'nu'"),
    "tab": (b"study:\n\tnu: 3\n", "line 2, column 1"),
    "indent": (b"study:\n  a: 1\n b: 2\n", "line 3"),
    "open quote": (b'title: "abc\n', "line 2"),
    "two documents": (b"a: 1\n---\nb: 2\n", "line 2"),
    "number as key": (b"1: 2\n", "line 1, column 1: a key is not a text"),
    "list as key": (b"[a, b]: 2\n", "line 1, column 1: a key is not a text"),
    "merge key": (b"a: &x {b: 1}\nc:\n  <<: *x\n", "aliases (*) are not supported"),
    "latin 1": ("title: Zähne".encode("latin-1"), "byte 8 is not UTF-8"),
    "utf-16": ("title: x".encode("utf-16"), "byte 0 is not UTF-8"),
    "nul": (b"title: \0", "not YAML"),
    "deep": (b"a: " + b"[" * 5000, "more than 12 levels"),
    "huge": (b"#" * 1_000_001, "larger than"),
    "no base": (b"base: missing.yaml", "missing.yaml: cannot be read (No such file"),
    "base a list": (b"base: [paper.yaml]", "base: found a list; allowed is the name of a file"),
    "itself": (b"base: study.yaml", "inherit in a circle"),
    "section missing": (b"title: x", "printed: missing; wanted is the numbers that the paper"),
    "section empty": (b"base: paper.yaml\nprinted: 7", "printed: found 7; allowed is a mapping"),
    "code": (b"title: !!python/name:os.system", "tags (!) are not supported"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_wrong_file_is_told_in_one_line(write, name):
    text, expected = BAD_FILES[name]
    file = write(text)
    with pytest.raises(InputError) as caught:
        load_study(file)
    assert str(caught.value).startswith(str(file))
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_places_that_are_no_files(tmp_path):
    with pytest.raises(InputError, match=r"missing\.yaml: cannot be read \(No such file"):
        load_study(tmp_path / "missing.yaml")
    with pytest.raises(InputError, match="cannot be read \\(Is a directory"):
        load_study(tmp_path)


def test_a_missing_reason_is_named(write):
    file = write("base: paper.yaml\nreasons: {module: }")
    with pytest.raises(InputError, match=r"reasons\.module: missing; every assumed key needs"):
        load_study(file)


def test_several_mistakes_are_counted(paper):
    with pytest.raises(InputError, match=r"found 3; unit missing.*\(and 1 more\)"):
        load_study(paper, ["assumed.backlash=3", "assumed.module=3"])


@fuzz
@given(data=st.data())
def test_damaged_text_never_escapes_as_another_error(write, paper, data):
    text = bytearray(paper.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text) - 1))
        junk = data.draw(
            st.sampled_from([b"", b":", b"\t", b"[", b"-", b"\xff", b"'", b"0", b"\n"])
        )
        text[at : at + data.draw(st.integers(0, 3))] = junk
    try:
        assert isinstance(load_study(write(bytes(text))), Study)
    except InputError as error:
        assert "\n" not in str(error)


KEYS = st.sampled_from(
    ["printed", "printed.teeth", "assumed", "assumed.backlash", "reasons.backlash", "run", "study",
     "study.nu", "study.nu.start", "study.nu.values", "study.variants", "study.time_courses",
     "study.time_courses.c-material", "study.strong_damping", "study.strong_damping.nu", "title"]
)  # fmt: skip
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(string.printable)
VALUES = st.recursive(
    SCALARS, lambda v: st.lists(v, max_size=3) | st.dictionaries(st.text(max_size=5), v, max_size=3)
)


@fuzz
@given(key=KEYS | st.text(string.printable, max_size=20), value=VALUES)
def test_any_value_anywhere_is_a_study_or_an_input_error(paper, key, value):
    flow = yaml.safe_dump(value, default_flow_style=True, allow_unicode=True)
    try:
        load_study(paper, [f"{key}={flow.removesuffix('...' + chr(10))}"])
    except InputError as error:
        assert len(str(error)) < 2000
