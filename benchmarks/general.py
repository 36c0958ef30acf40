"""What the general solver costs beside the reduced one: ``python -m benchmarks.general``.

The 27 single runs of `benchmarks.cases`, each in a call of its own, with estimates of the errors,
as the pipeline calls the solvers. Times are CPU times, the least of several rounds. The machine
code of the equations (`gearmesh.solvers.full.recurrences`) is made once in a process for every kind
of law, not for every mesh frequency or value of a parameter; its time is listed apart.
"""

import time
from collections.abc import Callable
from dataclasses import replace

from benchmarks.cases import singles
from gearmesh.model.problem import Problem, Wheel
from gearmesh.solvers.full import coordinates, recurrences
from gearmesh.solvers.full.runs import integrate
from gearmesh.solvers.simulation import simulate

TOLERANCE = 1e-10
ROUNDS = 7


def main() -> None:
    """Print the times of all runs together, and their ratios."""
    runs = [problem for problems in singles().values() for problem in problems]
    reduced = _least(lambda problem: simulate([problem], TOLERANCE), runs)
    print(f"reduced solver: {1e3 * reduced / len(runs):.2f} ms a run")
    for name, changed in (
        ("the same runs, two coordinates", runs),
        ("two different wheels, three coordinates", [_geared(problem) for problem in runs]),
        ("run-out, six coordinates", [replace(problem, eccentricity_3=0.5) for problem in runs]),
    ):
        spent = _least(lambda problem: integrate(problem, TOLERANCE), changed)
        each = 1e3 * spent / len(runs)
        print(f"general solver, {name}: {each:.2f} ms a run, {spent / reduced:.1f} times as long")
        made = _least(_prepare, changed[:1])
        print(f"    machine code of the equations of one law: {1e3 * made:.0f} ms")


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


def _prepare(problem: Problem) -> None:
    phases, _ = coordinates.kinds_of_period(problem)
    recurrences._recurrences.cache_clear()
    recurrences._compiled.cache_clear()
    recurrences.recurrences(problem, phases, sampled=False)


def _least(solve: Callable[[Problem], object], problems: list[Problem]) -> float:
    """Return the least CPU time in s that the problems take together."""
    spent = []
    for _ in range(ROUNDS + 1):  # the first round compiles
        start = time.process_time()
        for problem in problems:
            solve(problem)
        spent.append(time.process_time() - start)
    return min(spent[1:])


if __name__ == "__main__":
    main()
