"""The public test problems: their digits solve their equations, and the library finds them."""

import pytest

from benchmarks.orbits.answers import POSED
from benchmarks.orbits.known import Case, cases

CASES = [pytest.param(case, id=case.name) for case in cases()]


@pytest.mark.parametrize("case", CASES)
def test_the_digits_solve_the_equations(case: Case):
    assert case.exact
    for answer in case.exact:
        assert case.defect(answer) < 4e-15


@pytest.mark.parametrize("case", [one for one in CASES if one.values[0].problem in POSED])
def test_the_library_finds_the_exact_answers(case: Case):
    answer, bound = POSED[case.problem]
    assert answer(case) == pytest.approx(case.exact, abs=bound, rel=0)
