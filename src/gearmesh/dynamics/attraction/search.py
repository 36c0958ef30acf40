"""The attractors of one gear pair at one frequency, as far as they are known."""

import math

import numpy as np

from gearmesh.dynamics.attraction.attractors import Attractor, stable_orbits_near
from gearmesh.dynamics.attraction.envelopes import RISE, envelope_of
from gearmesh.dynamics.attraction.irregular import irregular_kinds
from gearmesh.dynamics.attraction.kinds import LOST, NEUTRAL, PERIODIC
from gearmesh.dynamics.attraction.maps import PoincareMap
from gearmesh.dynamics.attraction.regions import Region, region_of
from gearmesh.dynamics.periodic.shots import Shot
from gearmesh.solvers.reduced.runs import is_reducible

_TRIED = 64  # states near which orbits are searched for
_SEARCHES = 2  # searches among them
_MOST_SHALLOW = 0.2  # in y_st


class Search:
    """The attractors that are known, and the means to recognise them.

    Attributes
    ----------
    moved : PoincareMap
    problem : Problem
        All states are taken at its initial phase.
    envelope : Envelope or None
        None if only the general solver serves the gear pair.
    attractors : list of Attractor
    """

    def __init__(self, moved: PoincareMap) -> None:
        self.moved = moved
        self.problem = moved.problem
        self.envelope = envelope_of(self.problem) if is_reducible(self.problem) else None
        self.attractors: list[Attractor] = []
        self._regions: list[tuple[int, Region]] = []
        self._shallow = 0.0

    def label(self, found: Attractor) -> int:
        """Return the index of an attractor, which is new or known."""
        for i, known in enumerate(self.attractors):
            if known.same_as(found):
                return i
        self.attractors.append(found)
        return len(self.attractors) - 1

    def neutral(self) -> int:
        """Return the index of neutral motion."""
        constant = self.envelope.time_constant if self.envelope else math.inf
        rate = -1.0 / (constant * self.problem.period)
        return self.label(Attractor(NEUTRAL, exponent=rate, time_constant=constant))

    def captured(self, states: np.ndarray) -> np.ndarray:
        """Return the index of the attractor that holds each state, -1 if none does."""
        labels = np.full(len(states), -1)
        failed = np.isnan(states[:, 0])
        if failed.any():
            labels[failed] = self.label(Attractor(LOST))
        places = self.moved.coordinates(states)
        for i, region in self._regions:
            open_ = np.flatnonzero(labels < 0)
            labels[open_[region.holds(places[open_])]] = i
        if self.envelope:
            open_ = np.flatnonzero(labels < 0)
            inside = open_[self.envelope.is_above(states[open_], -self._shallow)]
            if inside.size:
                labels[inside] = self.neutral()
        return labels

    def find_orbits(self, states: np.ndarray) -> None:
        """Search for stable orbits near states of runs that are not over."""
        some = states[:: math.ceil(len(states) / _TRIED)]
        for orbit in stable_orbits_near(self.moved, some, _SEARCHES):
            self._add(orbit)

    def _add(self, orbit: Shot) -> None:
        """Add a stable orbit to what is known."""
        if not any(one.same_as(Attractor(PERIODIC, orbit)) for one in self.attractors):
            self._regions.append((len(self.attractors), region_of(self.moved, orbit)))
            self.attractors.append(Attractor.of(orbit))

    def learn(self, labels: np.ndarray, margins: np.ndarray) -> None:
        """Learn from finished runs how shallow contact losses are that vanish in the end.

        Parameters
        ----------
        labels : ndarray, shape (n,)
        margins : ndarray, shape (n,)
            Highest margin of each run after its first periods.
        """
        neutral = np.array([one.kind == NEUTRAL for one in self.attractors])[labels]
        if self.envelope is None or not neutral.any():
            return
        kept = [margins[~neutral]]
        kept += [self.envelope.margins(region.points) for _, region in self._regions]
        highest = float(np.concatenate(kept).max(initial=-math.inf))
        self._shallow = max(0.0, min(_MOST_SHALLOW, -0.5 * highest))

    def classified(self, states: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Return the attractors of motions that no orbit holds after the transient.

        Parameters
        ----------
        states : ndarray, shape (n, k)
        before : ndarray, shape (n,)
            Margins half a transient earlier.
        """
        labels = np.full(len(states), -1)
        if self.envelope and any(self.problem.lubricant):
            rising = np.isfinite(before) & (self.envelope.margins(states) > RISE * before)
            if rising.any():
                labels[rising] = self.neutral()
        open_ = np.flatnonzero(labels < 0)
        if open_.size:
            kinds, rates = irregular_kinds(self.moved, states[open_])
            for kind in set(kinds):
                are = np.array([one == kind for one in kinds])
                rate = float(np.mean(rates[are]))
                labels[open_[are]] = (
                    self.neutral()
                    if kind == NEUTRAL
                    else self.label(Attractor(kind, exponent=rate))
                )
        return labels
