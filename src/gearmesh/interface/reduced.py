"""Requests that the reduced system answers."""

from gearmesh.errors import InputError
from gearmesh.interface.statements import read_frequency, read_variant
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.solvers.reduced.runs import is_reducible
from gearmesh.study.pair import Pair
from gearmesh.study.speeds import check_constant_speed


def reduced_problem(pair: Pair, variant: str | Variant, nu: float | str) -> Problem:
    """Return what a request states; raises InputError if it is not of the reduced system."""
    check_constant_speed(pair, "this request")
    problem = pair.problem(read_variant(variant), read_frequency(nu, pair))
    if not is_reducible(problem):
        raise InputError(
            "pair: found unequal wheels, run-out, profile deviation, Fourier stiffness or another "
            "general term; allowed here are pairs without any; orbits and branches take all pairs"
        )
    return problem
