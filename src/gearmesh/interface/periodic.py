"""Requests that need an excitation that repeats."""

from gearmesh.dynamics.attraction.maps import map_of
from gearmesh.errors import InputError, NoOrbit
from gearmesh.interface.statements import check_pair, read_frequency, read_variant
from gearmesh.model.problem import Problem
from gearmesh.model.variants import Variant
from gearmesh.study.pair import Pair
from gearmesh.study.speeds import check_constant_speed


def periodic_problem(pair: Pair, variant: str | Variant, nu: float | str) -> Problem:
    """Return what a request states; raises InputError if the excitation never repeats."""
    check_pair(pair)
    check_constant_speed(pair, "this request")
    problem = pair.problem(read_variant(variant), read_frequency(nu, pair))
    try:
        map_of(problem)
    except NoOrbit as error:
        raise InputError(f"pair: {error}; allowed are multiples of one turn of both") from None
    return problem
