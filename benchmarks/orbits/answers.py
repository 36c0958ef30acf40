"""What gearmesh answers to the test problems: `python -m benchmarks.orbits.answers`.

The bodies of the wheels stand still, so that the mesh alone moves. Problems with a sinusoidal
drive, an impact or a map are not the library's; they are for other solvers.
"""

from collections.abc import Callable

import numpy as np

from benchmarks.orbits.known import Case, cases
from gearmesh.dynamics.attraction.lyapunov import lyapunov_spectrum
from gearmesh.dynamics.continuation.branches import follow
from gearmesh.dynamics.periodic.orbits import find_orbit
from gearmesh.dynamics.starts import linear_orbit
from gearmesh.model.problem import Problem
from gearmesh.solvers.reduced.derivatives.period_map import passage
from gearmesh.solvers.reduced.derivatives.variational import HEIGHT, KIND, TIME, TURN

Answers = dict[str, float]


def meissner(case: Case) -> Answers:
    """Return the trace of the mesh's part of the Jacobian."""
    problem = _posed(case)
    moved = passage(problem, linear_orbit(problem))
    return {"trace": float(np.trace(moved.jacobian[:2, :2]))}


def tongue(case: Case) -> Answers:
    """Return the flips of the branch of the motion in contact."""
    branch = follow(find_orbit(_posed(case, nu=0.645)), "nu", (0.64, 0.68))
    below, above = (point.nu for point in branch.special if point.kind == "flip")
    return {"below": below, "above": above}


def grazing(case: Case) -> Answers:
    """Return the grazing of the same branch."""
    branch = follow(find_orbit(_posed(case, nu=0.75)), "nu", (0.74, 0.8))
    (nu,) = (point.nu for point in branch.special if point.kind == "grazing_front")
    return {"nu": nu}


def lyapunov(case: Case) -> Answers:
    """Return the exponents of the mesh; the bodies come to rest faster."""
    problem = _posed(case)
    exponents = lyapunov_spectrum(problem, find_orbit(problem).state, 100).exponents
    first, second = exponents[:2]
    return {"first": float(first), "second": float(second)}


def liouville(case: Case) -> Answers:
    """Return the product of the multipliers of the orbit that the library finds first."""
    orbit = find_orbit(_posed(case))
    return {"product": float(np.linalg.det(orbit.passage.jacobian[:2, :2]))}


def backlash(case: Case) -> Answers:
    """Return the second extremum's time, at which y is greatest again, and the first's height."""
    problem = _posed(case, nu=0.5)
    moved = passage(problem, np.array([case.parameters["highest"], 0.0, 0.0, 0.0]))
    turns = moved.events[moved.events[:, KIND] == TURN]
    turns = turns[turns[:, TIME] > 0.0]
    return {"period": float(turns[1, TIME]), "lowest": float(turns[0, HEIGHT])}


POSED: dict[str, tuple[Callable[[Case], Answers], float]] = {
    "meissner": (meissner, 1e-14),
    "tongue": (tongue, 1e-12),
    "grazing": (grazing, 1e-12),
    "lyapunov": (lyapunov, 1e-14),
    "liouville": (liouville, 1e-14),
    "backlash": (backlash, 1e-14),
}
"""How the library answers, by problem, and the bound of its error."""


def _posed(case: Case, nu: float = 0.0) -> Problem:
    """Return the problem of the library, with linear damping wherever D is given."""
    given = {"nu": nu, "epsilon": 1.5, "kappa": 1.0, "s": 1e3, "D": 0.0} | case.parameters
    epsilon, kappa = given["epsilon"], given["kappa"]
    stiffest = 1.0 / (kappa + (1.0 - kappa) * (epsilon - 1.0))
    law = (2.0 * given["D"], 0.0, 0.0)
    return Problem(
        nu=given["nu"],
        contact_ratio=epsilon,
        stiffness_max=stiffest,
        stiffness_min=kappa * stiffest,
        material=law,
        lubricant=law,
        backlash=given["s"],
        body_mass=1e30,
        bearing_stiffness=1e30,
        bearing_damping_ratio=0.5,
        friction_coefficient=0.0,
        pressure_angle=0.35,
        teeth=21,
        base_radius=1.0,
    )


def main() -> None:
    """Print the errors."""
    print(f"{'case':28}{'answer':12}{'exact':>22}{'error':>10}")
    for case in cases():
        answer = POSED.get(case.problem)
        found = answer[0](case) if answer else {}
        for name, exact in case.exact.items():
            error = f"{abs(found[name] - exact):10.0e}" if answer else f"{'not posed':>10}"
            print(f"{case.name:28}{name:12}{exact:22.16f}{error}")


if __name__ == "__main__":
    main()
