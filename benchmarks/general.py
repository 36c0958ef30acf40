"""What the general solver costs beside the reduced one: ``python -m benchmarks.general``.

The 27 single runs of `benchmarks.cases`, each in a call of its own, once alone and once with the
companion that estimates the errors, as the pipeline calls the solvers. The reduced solver carries
the companion in another lane of the same vector. The general solver integrates one after the other,
and prepares both together. Times are CPU times, the least of several rounds. All solvers take turns
in a round, so that a load on the machine slows all of them.

The machine code of the equations (`gearmesh.solvers.full.recurrences`) is made once in a process
for every kind of law, not for every mesh frequency or value of a parameter. The first run, which
has it made, is listed apart.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from benchmarks.cases import singles
from gearmesh.model.problem import GeneralTerms, Problem, Wheel
from gearmesh.solvers.full import recurrences
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.simulation import simulate

TOLERANCE = 1e-10
ROUNDS = 7


def main() -> None:
    """Print the times of all runs together, and their ratios."""
    runs = [problem for problems in singles().values() for problem in problems]
    kinds = {
        "the same runs, two coordinates": runs,
        "two different wheels, three coordinates": [_geared(problem) for problem in runs],
        "run-out, six coordinates": [replace(problem, eccentricity_3=0.5) for problem in runs],
    }
    for companion in (False, True):
        solvers: dict[str, tuple[Callable[[Problem], object], list[Problem]]] = {
            "reduced": (partial(_reduced, companion), runs)
        }
        for kind, changed in kinds.items():
            solvers[kind] = partial(_general, companion), changed
        spent = {name: 1e3 * least / len(runs) for name, least in _least(solvers).items()}
        reduced = spent.pop("reduced")
        print("with estimates of the errors" if companion else "the run alone")
        print(f"    reduced solver: {reduced:.2f} ms a run")
        for kind, each in spent.items():
            ratio = each / reduced
            print(f"    general solver, {kind}: {each:.2f} ms a run, {ratio:.1f} times as long")
    kinds["pitch errors, run-out and friction"] = [_faulty(runs[0])]
    made = _least({kind: (_first, changed[:1]) for kind, changed in kinds.items()})
    for kind, seconds in made.items():
        print(f"first run of a law, {kind}: {1e3 * seconds:.0f} ms")


def _reduced(companion: bool, problem: Problem) -> object:
    return simulate([problem], TOLERANCE, estimate_errors=companion)


def _general(companion: bool, problem: Problem) -> object:
    return integrate(problem, TOLERANCE, estimate_errors=companion)


def _geared(problem: Problem) -> Problem:
    """Return the run with a wheel of twice the teeth and another bearing."""
    pinion = problem.both_wheels[0]
    wheel = Wheel(
        2 * pinion.teeth,
        2.0 * pinion.base_radius,
        2.0,
        2.0 * pinion.body_mass,
        pinion.bearing_stiffness,
        pinion.bearing_damping_ratio,
    )
    return replace(problem, wheels=(pinion, wheel))


def _faulty(problem: Problem) -> Problem:
    """Return the run with a pitch error of one tooth of each wheel, run-out and friction."""
    errors = (0.1, *[0.0] * (problem.teeth - 1))
    terms = GeneralTerms(
        pitch_errors_3=errors, pitch_errors_2=errors, tooth_pair_stiffness=(0.6, 0.9, 0.6)
    )
    return replace(
        problem, eccentricity_3=0.5, eccentricity_2=0.3, friction_coefficient=0.08, terms=terms
    )


def _first(problem: Problem) -> None:
    recurrences._recurrences.cache_clear()
    recurrences._compiled.clear()
    integrate(problem, TOLERANCE, estimate_errors=False)


def _least(
    solvers: dict[str, tuple[Callable[[Problem], object], list[Problem]]],
) -> dict[str, float]:
    """Return the least CPU time in s that the problems of each solver take together."""
    spent: dict[str, list[float]] = {name: [] for name in solvers}
    for _ in range(ROUNDS + 1):  # the first round compiles
        for name, (solve, problems) in solvers.items():
            start = time.process_time()
            for problem in problems:
                solve(problem)
            spent[name].append(time.process_time() - start)
    return {name: min(times[1:]) for name, times in spent.items()}


if __name__ == "__main__":
    main()
