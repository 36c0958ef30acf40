"""Response curves of one sample: separate runs, or sweeps up or down.

The searches of the ledger (`gearmesh.reproduction.thresholds`) run on these curves. Their scans are
coarser than those of the study itself, and they locate thresholds to ± 0.001. The spacing of a scan
depends on the variant. The scans of many samples are run together, sweeps step by step, to keep all
lanes of the solver busy.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from gearmesh.dynamics.response_curves import ResponseCurve
from gearmesh.identification.sampling.design import Sample, pair_of
from gearmesh.model.motion import state_at
from gearmesh.model.problem import Problem, State
from gearmesh.model.variants import variant
from gearmesh.reproduction.frequencies import FIRST, LAST
from gearmesh.reproduction.thresholds import LOOPS_FROM
from gearmesh.solvers.response import Response
from gearmesh.solvers.simulation import simulate
from gearmesh.study.pair import Pair

ACCURACY = 1e-3
"""Accuracy of thresholds in ν_s."""

# A ninth of the first decides between jump and slope (`response_curves.JUMP_WIDTH`),
# ninths of the others locate to `ACCURACY`: one refinement, eight runs, is enough.
_FINE, _MEDIUM, _COARSE, _COARSEST = 0.004, 0.01, 0.015, 0.02
_JUMPS_UP_TO = 0.92


def scan_of(name: str) -> np.ndarray:
    """Return the mesh frequencies of the scan of a variant, ascending.

    With damping in the lubricant alone, jumps and long transients need a close scan.
    With linear damping in the material there are jumps too, but far apart. All other curves are
    smooth. The loops of c-material are followed down to `LOOPS_FROM`.
    """
    if name.endswith("lubricant"):
        return np.concatenate(
            [_spaced(FIRST, _JUMPS_UP_TO, _FINE), _spaced(_JUMPS_UP_TO, LAST, _MEDIUM)[1:]]
        )
    if name.startswith("b-"):
        return _spaced(FIRST, LAST, _MEDIUM)
    smooth = _spaced(FIRST, LAST, _COARSE)
    if not name.startswith("c-material"):
        return smooth
    return np.concatenate([_spaced(LOOPS_FROM, FIRST, _COARSEST)[:-1], smooth])


def _spaced(low: float, high: float, spacing: float) -> np.ndarray:
    return np.round(np.linspace(low, high, round((high - low) / spacing) + 1), 10)


class SampledCurve(ResponseCurve):
    """The response curve of one variant of a sample.

    Parameters
    ----------
    sample : Sample
        Values of the open parameters.
    study : Pair
        All others.
    name : str
        Name of the variant.
    """

    width = 2.0 * ACCURACY
    steepest = 1

    def __init__(self, sample: Sample, study: Pair, name: str) -> None:
        pair = pair_of(sample, study)
        super().__init__(self.problem, pair.tolerance, name)
        # Only ν_s and the initial condition change; stating a run takes as long as running it.
        self._stated = pair.problem(variant(name), FIRST)
        self._samples_per_period = pair.samples_per_period
        self._kind = sample["kind"]
        velocity = float(sample["initial_velocity"])
        self._start = state_at(self._stated, v=velocity) if velocity else None
        self.grid = scan_of(name)
        if self._kind == "down":
            self.grid = self.grid[::-1]

    @property
    def swept(self) -> bool:
        """Whether each run starts from the end of its neighbour's run."""
        return self._kind != "separate"

    @property
    def tolerance(self) -> float:
        """Tolerance of the runs."""
        return self._tolerance

    def scan(self, low: float, high: float) -> np.ndarray:
        """Return the two ends and the frequencies of the scan between them."""
        if high < low:
            return np.empty(0)
        inside = self.grid[(self.grid > low) & (self.grid < high)]
        return np.unique(np.concatenate([[low], inside, [high]]))

    def learn(self, nu: Iterable[float], responses: Iterable[Response]) -> None:
        """Store responses."""
        self._known.update(zip(map(float, nu), responses, strict=True))

    def problem(self, nu: float) -> Problem:
        """State the run at one ν_s; in a sweep it starts at the end of its neighbour's run."""
        start = self._neighbours_end(nu) if self.swept else None
        return replace(self._stated, nu=nu, initial_state=start or self._start)

    def _neighbours_end(self, nu: float) -> State | None:
        """Return the state at the end of the run before `nu` in the sweep, if there is one."""
        passed = self.grid < nu if self._kind == "up" else self.grid > nu
        known = self._known.get(float(self.grid[passed][-1])) if passed.any() else None
        return known.final_state if known else None

    def time_course(self, nu: float) -> Response:
        """Return the response at one ν_s with its samples."""
        return simulate(
            [self.problem(nu)], self.tolerance, self._samples_per_period, estimate_errors=False
        )[0]


def scan_all(curves: Sequence[SampledCurve]) -> None:
    """Run the scans of all `curves`: separate runs at once, sweeps side by side."""
    separate = [(c, float(nu)) for c in curves if not c.swept for nu in c.grid]
    _run(separate)
    sweeps = [c for c in curves if c.swept]
    for step in range(max((c.grid.size for c in sweeps), default=0)):
        _run([(c, float(c.grid[step])) for c in sweeps if step < c.grid.size])


def _run(wanted: Sequence[tuple[SampledCurve, float]]) -> None:
    if not wanted:
        return
    problems = [curve.problem(nu) for curve, nu in wanted]
    found = simulate(problems, wanted[0][0].tolerance, estimate_errors=False)
    for (curve, nu), response in zip(wanted, found, strict=True):
        curve.learn([nu], [response])
