"""The numbers of a study as hashes, to compare them with those of another machine.

A hash is that of the bytes of one variable, not of a file: titles, versions of packages and the
format of a file do not matter, and if numbers differ, their names are known. One hash stands for a
variable in all case files of a letter of Tab. 1.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

DATASETS = ("datasets/resonance.nc", "datasets/bifurcation.nc")
HEADER = (
    "# SHA-256 of the numbers of config/paper.yaml; written by python -m verification --publish"
)


@dataclass(frozen=True)
class Numbers:
    """The numbers of a study beside the published ones, by their names."""

    agreeing: int
    differing: tuple[str, ...]
    missing: tuple[str, ...]
    unpublished: tuple[str, ...]

    @property
    def agree(self) -> bool:
        """Whether all published numbers are there."""
        return self.agreeing > 0 and not self.differing and not self.missing

    def to_dict(self) -> dict[str, Any]:
        """Return them for JSON."""
        return {
            "agreeing": self.agreeing,
            "differing": [*self.differing],
            "missing": [*self.missing],
            "unpublished": [*self.unpublished],
        }


def files(results: Path) -> dict[str, str]:
    """Return the SHA-256 of the dataset files, by which a reader knows what was verified."""
    return {name: hashlib.sha256((results / name).read_bytes()).hexdigest() for name in DATASETS}


def publish(results: Path, path: Path) -> None:
    """Write the hashes of all numbers."""
    lines = [f"{digest}  {name}" for name, digest in sorted(digests(results).items())]
    path.write_text("\n".join([HEADER, *lines]) + "\n", encoding="utf-8")


def compare(results: Path, path: Path) -> Numbers:
    """Compare the hashes of all numbers with the published ones."""
    lines = path.read_text(encoding="utf-8").splitlines()
    pairs = [line.split("  ", 1) for line in lines if not line.startswith("#")]
    published = {name: digest for digest, name in pairs}
    found = digests(results)
    both = found.keys() & published.keys()
    differing = tuple(sorted(name for name in both if found[name] != published[name]))
    return Numbers(
        agreeing=len(both) - len(differing),
        differing=differing,
        missing=tuple(sorted(published.keys() - found.keys())),
        unpublished=tuple(sorted(found.keys() - published.keys())),
    )


def digests(results: Path) -> dict[str, str]:
    """Return the SHA-256 of all numbers of a study.

    Returns
    -------
    dict of str to str
        By names such as ``cases/c/y_max``, ``datasets/resonance.nc/y_max``,
        ``datasets/thresholds.json/jump`` and ``claims.json/F2.1``.
    """
    totals: dict[str, Any] = {}
    for name, content in _numbers(results):
        totals.setdefault(name, hashlib.sha256()).update(content)
    return {name: total.hexdigest() for name, total in totals.items()}


def _numbers(results: Path) -> Iterator[tuple[str, bytes]]:
    for path in sorted((results / "cases").glob("*/*.nc")):
        letter = path.parent.name.partition("-")[0]
        case = path.relative_to(results).as_posix().encode()
        for name, content in _variables(path):
            yield f"cases/{letter}/{name}", case + content
    for dataset in DATASETS:
        for name, content in _variables(results / dataset):
            yield f"{dataset}/{name}", content
    thresholds = json.loads((results / "datasets/thresholds.json").read_text(encoding="utf-8"))
    for name, value in thresholds.items():
        yield f"datasets/thresholds.json/{name}", json.dumps(value, sort_keys=True).encode()
    for claim in json.loads((results / "claims.json").read_text(encoding="utf-8")):
        measured = json.dumps(claim["measured"], sort_keys=True)
        yield f"claims.json/{claim['id']}", measured.encode()


def _variables(path: Path) -> Iterator[tuple[str, bytes]]:
    """Yield the numerical variables of a file, with their kind, shape and bytes."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        for name, variable in file.variables.items():
            if isinstance(variable.dtype, np.dtype) and variable.dtype.kind in "if":
                values = np.asarray(variable[...])
                little = values.astype(values.dtype.newbyteorder("<"))
                yield name, repr((little.dtype.str, little.shape)).encode() + little.tobytes()
