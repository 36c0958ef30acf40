"""Integration of runs, one or thousands, to a tolerance.

`simulate` is the entry to both solvers: the compiled sweep over SIMD lanes
(`gearmesh.solvers.reduced.sweep`) for the reduced system, and the general solver
(`gearmesh.solvers.full.runs`) for what the reduction leaves out: different wheels, run-out, profile
deviation, and all stiffnesses and forces beyond those of the paper's examples.
"""

from collections.abc import Sequence

from gearmesh.model.problem import Problem
from gearmesh.solvers.response import Response

_CHUNK = 256


def simulate(
    problems: Sequence[Problem],
    tolerance: float = 1e-10,
    samples_per_period: int = 0,
    estimate_errors: bool = True,
) -> list[Response]:
    """Integrate `problems` and measure their responses.

    Parameters
    ----------
    problems : sequence of Problem
        The runs; each is independent of the others, to the last bit.
    tolerance : float
        Bound of the local error of a step, in y_st and y_st Omega_s.
    samples_per_period : int
        Samples of the time course in each kept mesh period; 0 for none.
    estimate_errors : bool
        Whether every run has a companion, `LOOSENING` times less accurate and displaced by the
        tolerance at the start, for the estimates `Response.y_max_error`, `y_min_error` and
        `sensitive`. Costs less than the run.

    Returns
    -------
    list of Response
        In the order of `problems`. A run that fails has a status other than ``"ok"``. Samples of
        runs that were solved together are pieces of one array: copy those that you keep.
    """
    # numba is loaded at the first run: code that only reads results imports this module, too.
    from gearmesh.solvers.reduced import runs as reduced

    responses: dict[int, Response] = {}
    reducible = [i for i, problem in enumerate(problems) if reduced.is_reducible(problem)]
    for first in range(0, len(reducible), _CHUNK):
        chunk = reducible[first : first + _CHUNK]
        found = reduced.integrate(
            [problems[i] for i in chunk], tolerance, samples_per_period, estimate_errors
        )
        responses.update(zip(chunk, found, strict=True))
    if len(reducible) < len(problems):
        from gearmesh.solvers.full.runs import integrate

        for i, problem in enumerate(problems):
            if i not in responses:
                responses[i] = integrate(
                    problem, tolerance, samples_per_period, estimate_errors=estimate_errors
                )
    return [responses[i] for i in range(len(problems))]
