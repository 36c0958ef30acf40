"""Studies and their cases: what a file inherits, and what it may ask for."""

import re
import string

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmesh.data.paths import Places
from gearmesh.errors import InputError
from gearmesh.model.variants import VARIANTS
from gearmesh.study.loading import load_study


def files(study):
    return {Places("any").case(case.variant.name, case.nu) for case in study.cases}


def test_the_study_of_the_paper_has_every_variant_on_its_grid(study):
    cases = study.cases
    grid = {case.nu for case in cases if case.variant.name == "d-both"}
    assert len(grid) == 241
    assert {case.variant.name for case in cases} == {*VARIANTS, "c-material-5x"}
    assert {0.6, 0.66, 1.05, 1.2} <= grid
    assert len(set(cases)) == len(cases) >= 22 * 241 + 81
    courses = {case.variant.name for case in cases if case.time_course}
    assert courses == {"c-lubricant", "c-material", "c-material-5x"}
    assert study.nu.shape == (241,)
    assert study.variants == (*VARIANTS, "c-material-5x")


def test_the_smoke_study_is_that_of_the_paper_with_fewer_frequencies(study, small_study):
    assert small_study.pair == study.pair
    assert small_study.pair.parameters == study.pair.parameters
    assert small_study.variants == study.variants
    assert 0 < len(small_study.cases) < len(study.cases) / 10


def test_a_time_course_off_the_grid_is_a_case(write):
    study = load_study(write("base: paper.yaml\ntime_courses: {b-both: [0.6051]}"))
    [case] = [case for case in study.cases if case.time_course and case.variant.name == "b-both"]
    assert case.nu == 0.6051
    assert sum(c.nu == case.nu for c in study.cases) == 1


def test_more_frequencies_keep_the_files_that_exist(write, study):
    more = load_study(write("base: paper.yaml\nnu: {values: [0.66125, 0.7001]}"))
    assert files(study) < files(more)


def test_only_cases_with_time_courses_have_files_where_the_study_says_so(write, study):
    sparse = load_study(write("base: paper.yaml\ncase_files: false"))
    assert {case for case in sparse.cases if sparse.has_file(case)} == {
        case for case in sparse.cases if case.time_course
    }
    assert all(study.has_file(case) for case in study.cases)


def test_the_name_title_and_claims_of_a_base_are_its_own(write, study):
    assert (study.name, study.claims.name) == ("paper", "claims.yaml")
    write("base: paper.yaml\nname: middle\ntitle: In the middle", "a.yaml")
    own = load_study(write("base: a.yaml", "my.study.yaml"))
    assert (own.name, own.title, own.claims) == ("my.study", "my.study", None)
    assert load_study(own.path.parent / "a.yaml").title == "In the middle"


def test_a_ledger_of_claims_stands_beside_the_file_that_names_it(write):
    file = write("base: paper.yaml\nclaims: mine.yaml")
    assert load_study(file).claims == file.parent / "mine.yaml"


def test_a_file_replaces_values_and_adds_to_the_plan_of_its_base(write):
    write("base: paper.yaml\nbacklash: 30 um\nstrong_damping: {nu: {step: 0.05}}", "a.yaml")
    study = load_study(write("base: a.yaml\nmodule: 2 mm\ntime_courses: {c-material: }"))
    assert (study.pair.backlash, study.pair.module) == (0.03, 2.0)
    assert study.plan.strong_damping.nu.all == (0.6, 0.65, 0.7, 0.75, 0.8)
    assert study.plan.strong_damping.factor == 5
    assert set(study.time_courses) == {"c-lubricant", "c-material-5x"}


def test_a_list_of_a_base_is_replaced_and_not_continued(write):
    study = load_study(write("base: paper.yaml\ntime_courses: {c-lubricant: [0.7]}"))
    assert study.time_courses["c-lubricant"] == (0.7,)


def test_inherited_plans_for_cases_that_a_file_does_not_have_are_left_out(write):
    study = load_study(write("base: paper.yaml\nvariants: [b-both, c-lubricant]"))
    assert study.variants == ("b-both", "c-lubricant")
    assert set(study.time_courses) == {"c-lubricant"}
    study = load_study(write("base: paper.yaml\nnu: {start: 0.9, stop: 1.1, step: 0.05}"))
    assert study.time_courses["c-lubricant"] == (1.05,)
    # The stronger damping has its own frequencies.
    assert study.time_courses["c-material-5x"][0] == 0.6


def test_an_inherited_stronger_damping_stays_if_its_variant_does(write):
    study = load_study(write("base: paper.yaml\nvariants: [c-material]"))
    assert study.variants == ("c-material", "c-material-5x")


def test_a_study_without_a_variant_is_one_for_the_files_that_inherit_it_too(write):
    write("base: paper.yaml\nvariants: [b-both]", "a.yaml")
    assert load_study(write("base: a.yaml\nmodule: 2 mm")).variants == ("b-both",)


def test_an_own_stronger_damping_need_not_be_that_of_a_variant(write):
    file = write(
        "base: paper.yaml\nvariants: [b-both]\nstrong_damping: {factor: 3, variant: c-material}"
    )
    assert load_study(file).variants == ("b-both", "c-material-3x")


MISTAKES = """
nu: 0.66 | nu: found 0.66; allowed is a mapping
nu: {start: 1.3} | nu.stop: found 1.2, below start; allowed is 1.3 to 10
nu: {start: null} | nu.start: missing; a grid has start, stop and step
nu: {step: 2.5e-5} | nu: makes
nu: {stp: 0.01} | nu.stp: unknown key (did you mean
nu: {values: [0.601, x]} | nu.values.1: found 'x'
variants: [c-lubicant] | variants.0: found 'c-lubicant'; unknown variant (did you mean 'c-lubricant'
variants: [i-both] | variants.0: found 'i-both'; unknown variant
variants: c-material | variants: found 'c-material'; allowed is a list of variants, or all
variants: 3 | variants: found 3; allowed is a list
variants: [] | variants: found none; allowed are names of Tab. 1
variants: [c-material, c-material] | variants: found c-material twice; allowed is once
variants: [3] | variants.0: found 3; unknown variant
direction: sideways | direction: found 'sideways'; allowed is 'up' or 'down'
strong_damping: 5 | strong_damping: found 5; allowed is a mapping
strong_damping: {factor: 1} | strong_damping.factor: found 1; allowed is any other than 1
strong_damping: {factor: -5} | strong_damping.factor: found -5; out of range
strong_damping: {factor: 5 y_st} | strong_damping.factor: found '5 y_st'; 'y_st' is not allowed here
strong_damping: {variant: a-conservative} | allowed is a variant with damping
strong_damping: {nu: {stop: 0.5}} | strong_damping.nu.stop: found 0.5, below start
time_courses: 0.6 | time_courses: found 0.6; allowed is a mapping
time_courses: {c-materal: [0.6]} | time_courses.c-materal: this variant is not computed (did you
time_courses: {c-lubricant: 0.6} | time_courses.c-lubricant: found 0.6; allowed is a list
time_courses: {c-lubricant: [3.0]} | time_courses.c-lubricant: found 3; allowed is 0.6 to 1.2
time_courses: {c-lubricant: [0.6, 0.6]} | time_courses.c-lubricant: found 0.6 twice
case_files: perhaps | case_files: found 'perhaps'; allowed is true or false
title: 5 | title: found 5; allowed is a text
title: '' | title: found ''; allowed is a text that is not empty
titel: x | titel: unknown key (did you mean 'title'?)
mechanisms: {variants: []} | mechanisms.variants: found none; allowed are names of Tab. 1
mechanisms: {variants: [c-both, c-both]} | mechanisms.variants: found c-both twice
mechanisms: {variants: [c-both], resolution: 0} | found 0; out of range; allowed is 2 to 1000
mechanisms: {variants: [c-both], resolution: x} | found 'x'; not a quantity
claims: [a] | claims: found a list of 1; allowed is a text
run: {revolutions: 5} | run: unknown key
solver: {tolerance: 1e-8} | solver: unknown key
"""


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        ("revolutions: 999\nkept_revolutions: 999", r": time_courses: found \d+ runs of letter"),
        (
            "loads: true\ndirection: up\nrevolutions: 9\nkept_revolutions: 9",
            r": loads: found 723 runs of letter b",
        ),
    ],
)
def test_a_study_that_keeps_too_many_samples_is_refused(write, stated, expected):
    study = load_study(write(f"base: paper.yaml\n{stated}"))
    with pytest.raises(InputError, match=expected):
        study.check_samples()


@pytest.mark.parametrize("mistake", MISTAKES.strip().splitlines())
def test_a_wrong_plan_is_reported_in_one_line(refused, mistake):
    stated, _, expected = mistake.partition(" | ")
    assert expected in refused(f"base: paper.yaml\n{stated}\n")


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        (
            "variants: [b-both]\nmechanisms: {variants: [c-both]}",
            "mechanisms.variants: found c-both, which is not computed; allowed are b-both",
        ),
        (
            "variants: [b-both]\ntime_courses: {c-material: [0.6]}",
            "time_courses.c-material: this variant is not computed",
        ),
        (
            "nu: {start: 0.9}\ntime_courses: {c-lubricant: [0.6]}",
            "time_courses.c-lubricant: found 0.6; allowed is 0.9 to 1.2",
        ),
        (
            "strong_damping: null\ntime_courses: {c-material-5x: [0.6]}",
            "time_courses.c-material-5x: this variant is not computed",
        ),
    ],
)
def test_an_own_time_course_of_a_case_that_is_not_computed_is_refused(refused, stated, expected):
    assert expected in refused(f"base: paper.yaml\n{stated}\n")


NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")
NAMES = st.text(string.ascii_letters + string.digits + "._-/\\ ~:é\n", min_size=1, max_size=70)


@settings(max_examples=150)
@given(name=NAMES | st.sampled_from(["..", ".", "../up", "a/b", "C:", "/", "a" * 65, "-", "1"]))
def test_a_name_is_letters_digits_dots_and_dashes_and_never_a_path(tmp_path_factory, name):
    folder = tmp_path_factory.getbasetemp() / "names"
    folder.mkdir(exist_ok=True)
    file = folder / "study.yaml"
    quoted = name.replace("\\", "\\\\").replace("\n", "\\n")
    file.write_text(f'{FEW}\nname: "{quoted}"\n', encoding="utf-8")
    if NAME.fullmatch(name) and not name.startswith("."):
        assert load_study(file).name == name
        # The folder of its results lies where all do.
        assert (folder / name).parent == folder
        return
    with pytest.raises(InputError, match=r"name: found .*; allowed are letters, digits, '\.', '_'"):
        load_study(file)


FEW = """
contact_ratio: 1.6
stiffness_ratio: 0.6
mesh_stiffness_max: 4e5 N/mm
reduced_mass: 3 kg
teeth: 21
damping: 4 N s/mm
pressure_angle: 20 deg
static_deflection: 10 um
backlash: 8 y_st
damping_length: 0.5 y_st
body_mass: 1000 m_red
bearing_stiffness: 1 C_s
bearing_damping_ratio: 0.03
friction_coefficient: 0.05
module: 3 mm
nu: {values: [0.7]}
variants: [b-both]
"""


def test_a_study_needs_no_base(write):
    study = load_study(write(FEW, "alone.yaml"))
    assert (study.name, len(study.cases)) == ("alone", 1)
    assert {p.kind for p in study.pair.parameters} == {"stated", "default", "setting"}


@pytest.mark.parametrize("name", ["my study.yaml", ".yaml", "a:b.yaml"])
def test_a_file_whose_name_is_no_name_of_a_study_must_state_one(write, name):
    with pytest.raises(InputError, match="without a name, that of the file is used"):
        load_study(write(FEW, name))
    assert load_study(write(FEW + "name: mine\n", name)).name == "mine"


@pytest.mark.parametrize("missing", ["teeth", "nu", "variants", "backlash", "static_deflection"])
def test_what_a_study_must_state_is_named(write, missing):
    text = "\n".join(line for line in FEW.splitlines() if not line.startswith(f"{missing}:"))
    with pytest.raises(InputError, match=f"{missing}: missing; "):
        load_study(write(text))
