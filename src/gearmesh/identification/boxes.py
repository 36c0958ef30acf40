"""Boxes in the unit cube, and how densely all designs together cover each place.

Few samples of an even design meet many claims at once. A focused design fills the box that the best
samples before it span, evenly again. Each sample then counts by the inverse of the density with
which all designs of its family together were drawn there (the balance heuristic of Veach and
Guibas, 1995): inside a box it is one over its volume, outside 0. So for given boxes shares and
regions mean the even prior. That the boxes come from the same samples is what `MARGIN` is for.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.identification import store
from gearmesh.identification.settings import KINDS, Design

MARGIN = 0.05
"""How far a box reaches beyond its samples on each side, as a share of their interval.

What fits reaches farther than the samples that were found in it. If the box ended at them, what
lies beside it would be sampled by nobody, and its share would be missed for good: a fifth of a
region in nine dimensions that 64 samples span. With this margin it is less than the noise.
"""

_PERIODIC = ("initial_phase", "kind")
"""Factors without ends. Any two of the three kinds are neighbours on their circle."""


@dataclass(frozen=True)
class Box:
    """A part of the unit cube: along each coordinate an interval, or an arc that may pass 1.

    Attributes
    ----------
    low, length : ndarray, shape (d,)
        Where it begins and how far it reaches; ``low + length`` passes 1 on an arc only.
    """

    low: np.ndarray
    length: np.ndarray

    @property
    def volume(self) -> float:
        """Its share of the unit cube."""
        return float(np.prod(self.length))

    def fill(self, points: np.ndarray) -> np.ndarray:
        """Return the places in the box of points of the unit cube, shape (n, d)."""
        return (self.low + self.length * points) % 1.0

    def density(self, places: np.ndarray) -> np.ndarray:
        """Return the density of its places, shape (n,), relative to that of an even design."""
        inside = np.all((places - self.low) % 1.0 <= self.length, axis=1)
        return inside / self.volume


def span(places: np.ndarray, factor: str) -> tuple[float, float]:
    """Return where the shortest interval or arc begins that holds all places, and its length.

    A margin is added at both ends; a kind of run is there or not.
    """
    ends = np.sort(places)
    if factor == "kind":
        ends = np.unique((ends * len(KINDS)).astype(int)) / len(KINDS)
    gaps = np.diff(ends, append=ends[0] + 1.0)
    widest = int(np.argmax(gaps)) if factor in _PERIODIC else len(gaps) - 1
    low, length = ends[(widest + 1) % len(ends)], 1.0 - gaps[widest]
    if factor == "kind":
        return float(low), float(length + 1.0 / len(KINDS))
    margin = MARGIN * length
    if factor in _PERIODIC:
        return float((low - margin) % 1.0), float(min(length + 2.0 * margin, 1.0))
    first, last = max(low - margin, 0.0), min(low + length + margin, 1.0)
    return float(first), float(last - first)


def box_of(places: np.ndarray, factors: Sequence[str]) -> Box:
    """Return the box that places span, shape (n, factors)."""
    spans = [span(column, factor) for column, factor in zip(places.T, factors, strict=True)]
    low, length = np.array(spans).T
    return Box(low, length)


def write_box(path: Path, box: Box, design: Design) -> None:
    """Write the box of a focused design."""
    content = xr.Dataset(
        {"low": ("factor", box.low), "length": ("factor", box.length)},
        {"factor": list(design.vary)},
    )
    store.write(path, content, "box of a focused design in the unit cube")


def read_box(path: Path) -> Box:
    """Read the box of a focused design."""
    content = store.open_file(path)
    return Box(content["low"].values, content["length"].values)


def prior_weights(places: np.ndarray, sizes: Sequence[int], boxes: Sequence[Box]) -> np.ndarray:
    """Return the weights that make samples of several designs an even one, with sum 1.

    Parameters
    ----------
    places : ndarray, shape (n, d)
        All samples of an even design and of the focused ones that followed it.
    sizes : sequence of int
        How many each design has: the even one, then one for each box.
    boxes : sequence of Box
        The focused designs.
    """
    share = np.array(sizes) / sum(sizes)
    density = np.full(len(places), share[0])
    for part, box in zip(share[1:], boxes, strict=True):
        density += part * box.density(places)
    return (1.0 / density) / np.sum(1.0 / density)
