"""Non-smooth test problems with exact answers, read from `problems/*.yaml`.

Each file states one problem in words and formulas, for any solver. `cases` gives parameters and
exact answers; `equations` says, in the notation of Python, which equation each answer solves.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import yaml

FOLDER = Path(__file__).parent / "problems"


@dataclass(frozen=True, slots=True)
class Case:
    """A problem at given parameters.

    Attributes
    ----------
    problem : str
        Name of the file.
    given : dict
        The parameters that tell the cases of a problem apart.
    parameters : dict
        All of them.
    exact : dict
        Answers by name.
    where, equations : dict
        Expressions for what the equations use, in their order; equations by answer.
    """

    problem: str
    given: dict[str, float]
    parameters: dict[str, float]
    exact: dict[str, float]
    where: dict[str, str]
    equations: dict[str, str]

    @property
    def name(self) -> str:
        """The problem and the parameters of the case."""
        return f"{self.problem} " + ", ".join(f"{k}={v:g}" for k, v in self.given.items())

    def defect(self, answer: str) -> float:
        """Return how far the exact answer is from solving its equation, in floating point."""
        scope = vars(math) | {"abs": abs, "max": max} | self.parameters | self.exact
        for name, expression in self.where.items():
            scope[name] = eval(expression, {"__builtins__": {}}, scope)
        left, right = (
            eval(side, {"__builtins__": {}}, scope) for side in self.equations[answer].split(" = ")
        )
        return abs(left - right)


def cases() -> list[Case]:
    """Return all cases of all problems."""
    found = []
    for file in sorted(FOLDER.glob("*.yaml")):
        stated = yaml.safe_load(file.read_text())
        found += [
            Case(
                file.stem,
                case["given"],
                stated["parameters"] | case["given"],
                case["exact"],
                stated["where"],
                stated["equations"],
            )
            for case in stated["cases"]
        ]
    return found


def case_of(problem: str) -> Case:
    """Return the first case of a problem."""
    return next(case for case in cases() if case.problem == problem)
