"""A term of the equations is stated in few places, and the guide names them all."""

from dataclasses import fields
from pathlib import Path

import pytest

from gearmesh.model.problem import GeneralTerms

SOURCE = Path(__file__).parents[2] / "src" / "gearmesh"
GUIDE = Path(__file__).parents[2] / "docs" / "howto" / "term.md"

STATED = {"model/problem.py", "model/motion.py", "study/parameters.py", "study/problem.py"}
"""A field, a law, a parameter, and its dimensionless form."""


def files_that_name(word: str) -> set[str]:
    return {
        file.relative_to(SOURCE).as_posix()
        for file in SOURCE.rglob("*.py")
        if word in file.read_text(encoding="utf-8")
    }


def test_the_worked_example_has_no_other_places():
    assert files_that_name("restoring_3") == STATED
    guide = GUIDE.read_text(encoding="utf-8")
    assert all(f"src/gearmesh/{place}" in guide for place in STATED)


@pytest.mark.parametrize("name", [field.name for field in fields(GeneralTerms)])
def test_no_law_is_stated_again_in_a_solver(name):
    """Solvers name a term for the limits of a step, an event, a coordinate, or single teeth.

    Constant torques are numbers of the recorded equations, so runs that differ in them share these.
    """
    allowed = {"limits.py", "full/runs.py", "full/tape.py", "full/coordinates.py"}
    solvers = {
        place.removeprefix("solvers/")
        for place in files_that_name(name)
        if place.startswith("solvers/")
    }
    if name == "non_adhesive":
        allowed |= {"full/kernel.py", "full/series.py"}
    if name.startswith("torque_harmonics"):
        allowed |= {"full/recurrences.py"}
    assert solvers <= allowed
