"""Compute what lies behind the response curves: branches of orbits, basins, sweeps and more."""

from collections.abc import Collection
from pathlib import Path

from gearmesh.data.paths import Places
from gearmesh.study.cases import Mechanisms, Study


def orbits(study: Study, places: Places, letter: str) -> list[Path]:
    """Follow the orbits of the variants of one letter of Tab. 1, and locate their special points.

    The special points are located a second time without friction and on rigid supports.
    """
    import json

    from gearmesh.data.writing import write_text
    from gearmesh.reproduction.mechanisms import tables
    from gearmesh.reproduction.mechanisms.orbits import WITHOUT_SUPPORTS, branches

    limits = float(study.nu[0]), float(study.nu[-1])
    pairs = [(study.pair, {}), (study.pair.replace(**WITHOUT_SUPPORTS), WITHOUT_SUPPORTS)]
    made, rows = [], []
    for pair, changed in pairs:
        for name in _mechanisms(study).by_letter[letter]:
            found = branches(pair, name, limits)
            rows += tables.rows(name, found, changed)
            made += [] if changed or not found else [tables.table(name, found)]
    dataset, points = places.orbits(letter)
    tables.write(dataset, tables.joined(made), study, "branches of orbits")
    write_text(points, json.dumps(rows))
    return [dataset, points]


def branches(study: Study, places: Places) -> list[Path]:
    """Put the branches and the special points of all letters together."""
    import json

    from gearmesh.data.datasets import open_dataset
    from gearmesh.data.writing import write_text
    from gearmesh.reproduction.mechanisms import tables

    letters = _mechanisms(study).by_letter
    _remove_other_letters(places, letters)
    files = [places.orbits(letter) for letter in letters]
    made = tables.joined(open_dataset(dataset) for dataset, _ in files)
    tables.write(places.branches, made, study, "branches of orbits")
    rows = [row for _, points in files for row in json.loads(points.read_text(encoding="utf-8"))]
    rows.sort(key=lambda row: "parameters" in row)
    write_text(places.special_points, json.dumps(rows, indent=1) + "\n")
    return [places.branches, places.special_points]


def _mechanisms(study: Study) -> Mechanisms:
    assert study.plan.mechanisms is not None  # without them there are no such rules
    return study.plan.mechanisms


def _remove_other_letters(places: Places, letters: Collection[str]) -> None:
    """Remove what is left of letters that the study had before."""
    orbits, manifests = places.orbits("x")[0].parent, places.manifest("x").parent
    for file in (*orbits.glob("*"), *manifests.glob("orbits-*")):
        if file.stem.rpartition("-")[2] not in letters:
            file.unlink()
