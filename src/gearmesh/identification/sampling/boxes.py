"""Boxes in the unit cube, and the weights of samples that were drawn in them.

Few samples of an even design meet many claims at once. A focused design fills, evenly, the box that
the best samples of the previous design span. The weight of each sample is the inverse of the
density with which all designs of its family together were drawn at its point (the balance heuristic
of Veach and Guibas, 1995). The density of a box is one over its volume inside, and 0 outside. With
these weights, shares and regions refer to the even prior if the boxes are given. The boxes come
from the same samples, however; `MARGIN` corrects for that.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from gearmesh.identification.factors import FACTORS, KINDS
from gearmesh.identification.sampling import store
from gearmesh.identification.settings import Design

MARGIN = 0.05
"""Extension of a box beyond its samples on each side, as a share of their interval.

The compatible region extends beyond the samples that were found in it. Without a margin, no design
would sample the rest of it: a fifth of a region in nine dimensions that 64 samples span. With this
margin, the missed share is smaller than the noise.
"""


@dataclass(frozen=True)
class Box:
    """A part of the unit cube: along each coordinate an interval, or an arc that may wrap at 1.

    Attributes
    ----------
    low, length : ndarray, shape (d,)
        Its lower end and its length; ``low + length`` exceeds 1 on an arc only.
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
    """Return the start and the length of the shortest interval or arc that holds all places.

    A margin is added at both ends, except for the kind of run, which has no values in between.
    """
    ends = np.sort(places)
    if factor == "kind":
        ends = np.unique((ends * len(KINDS)).astype(int)) / len(KINDS)
    gaps = np.diff(ends, append=ends[0] + 1.0)
    widest = int(np.argmax(gaps)) if FACTORS[factor].periodic else len(gaps) - 1
    low, length = ends[(widest + 1) % len(ends)], 1.0 - gaps[widest]
    if factor == "kind":
        return float(low), float(length + 1.0 / len(KINDS))
    margin = MARGIN * length
    if FACTORS[factor].periodic:
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
