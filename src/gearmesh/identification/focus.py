"""Samples around those that fit best, and how densely all designs together cover each place.

Few samples of an even design meet many claims at once. A focused design draws new ones around
the best (population Monte Carlo: Cappé et al., J. Comput. Graph. Stat. 13, 2004; Beaumont et al.,
Biometrika 96, 2009). Each sample then counts by the inverse of the density with which all designs
of its family together were drawn there (the balance heuristic of Veach and Guibas, 1995), so that
shares and regions mean the even prior again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.special import ndtri
from scipy.stats import norm, qmc

from gearmesh.claims import Claim
from gearmesh.identification import store
from gearmesh.identification.settings import KINDS, Design
from gearmesh.identification.store import Samples
from gearmesh.identification.wording import closeness, statements, weight_of_claims

PARENTS = 128
"""How many of the best samples a focused design surrounds."""

_SPREAD = 0.5
_KEEPS_KIND = 0.8
_PERIODIC = ("initial_phase", "eccentricity_angle")


@dataclass(frozen=True)
class Cloud:
    """Density of a focused design on the unit cube: a kernel around each parent.

    Attributes
    ----------
    parents : ndarray, shape (n, d)
        Places in the unit cube.
    factors : tuple of str
        What the d coordinates are.
    """

    parents: np.ndarray
    factors: tuple[str, ...]

    @property
    def widths(self) -> np.ndarray:
        """Standard deviation of the kernel along each coordinate, shape (d,)."""
        return np.maximum(_SPREAD * self.parents.std(axis=0), 0.01)

    def draw(self, count: int, seed: int) -> np.ndarray:
        """Return places, shape (count, d), that fill the cloud evenly; `count` a power of 2."""
        uniform = qmc.Sobol(len(self.factors) + 1, seed=seed).random(count)
        chosen = np.minimum((uniform[:, 0] * len(self.parents)).astype(int), len(self.parents) - 1)
        centres = self.parents[chosen]
        inner = np.clip(uniform[:, 1:], 1e-12, 1 - 1e-12)
        places = centres + ndtri(inner) * self.widths
        for j, name in enumerate(self.factors):
            if name == "kind":
                places[:, j] = _another_kind(centres[:, j], inner[:, j])
            else:
                places[:, j] = _folded(places[:, j], name in _PERIODIC)
        return places

    def density(self, places: np.ndarray) -> np.ndarray:
        """Return the density at places, shape (n,), relative to that of an even design."""
        total = np.ones((len(places), len(self.parents)))
        for j, name in enumerate(self.factors):
            here, centres = places[:, j, None], self.parents[None, :, j]
            if name == "kind":
                same = _kind(here) == _kind(centres)
                stays = _KEEPS_KIND + (1 - _KEEPS_KIND) / len(KINDS)
                total *= np.where(same, stays, (1 - _KEEPS_KIND) / len(KINDS)) * len(KINDS)
                continue
            images = [centres + shift for shift in (-1.0, 0.0, 1.0)]
            if name not in _PERIODIC:
                images = [centres, -centres, 2.0 - centres]
            total *= sum(norm.pdf(here, image, self.widths[j]) for image in images)
        return total.mean(axis=1)


def _folded(places: np.ndarray, periodic: bool) -> np.ndarray:
    """Bring places back into the unit interval: around it, or by reflection at its ends."""
    if periodic:
        return places % 1.0
    folded = np.abs(places) % 2.0
    return np.where(folded > 1.0, 2.0 - folded, folded)


def _kind(places: np.ndarray) -> np.ndarray:
    return np.minimum((places * len(KINDS)).astype(int), len(KINDS) - 1)


def _another_kind(centres: np.ndarray, uniform: np.ndarray) -> np.ndarray:
    """Return the kind of the parent, or now and then one drawn anew."""
    anew = (uniform - _KEEPS_KIND) / (1.0 - _KEEPS_KIND)
    return np.where(uniform < _KEEPS_KIND, centres, anew)


def best(held: np.ndarray, fit: np.ndarray, count: int = PARENTS) -> np.ndarray:
    """Return the indices of the samples that meet most claims; of equal ones the best fitting."""
    return np.lexsort((-fit, -held))[:count]


def around(before: Samples, design: Design, ledger: Sequence[Claim]) -> Cloud:
    """Return the cloud of a focused design around the best samples before it."""
    stated = statements(ledger)
    held = np.sum([w > 0 for w in weight_of_claims(stated, before.measured).values()], axis=0)
    fit = np.sum([closeness(statement, before.measured) for statement in stated], axis=0)
    return Cloud(before.unit(design.vary)[best(held, fit)], design.vary)


def write_cloud(path: Path, cloud: Cloud, design: Design) -> None:
    """Draw the samples of a focused design and write them, with the parents of its cloud."""
    content = xr.Dataset(
        {
            "place": (("sample", "factor"), cloud.draw(design.points, design.seed)),
            "parent": (("parent_sample", "factor"), cloud.parents),
        },
        {"factor": list(design.vary)},
    )
    store.write(path, content, "places of a focused design in the unit cube")


def read_cloud(path: Path) -> Cloud:
    """Read the cloud that a focused design was drawn from."""
    content = store.open_file(path)
    return Cloud(content["parent"].values, tuple(content["factor"].values.tolist()))


def prior_weights(places: np.ndarray, sizes: list[int], clouds: list[Cloud]) -> np.ndarray:
    """Return the weights that make samples of several designs an even one, with sum 1.

    Parameters
    ----------
    places : ndarray, shape (n, d)
        All samples of an even design and of the focused ones that followed it.
    sizes : list of int
        How many each design has: the even one, then one for each cloud.
    clouds : list of Cloud
        The focused designs.
    """
    share = np.array(sizes) / sum(sizes)
    density = np.full(len(places), share[0])
    for weight, cloud in zip(share[1:], clouds, strict=True):
        density += weight * cloud.density(places)
    return (1.0 / density) / np.sum(1.0 / density)
