"""Put the cases together, and locate thresholds between them."""

from pathlib import Path

from gearmesh.data.paths import Places
from gearmesh.study.cases import Study


def datasets(study: Study, places: Places) -> list[Path]:
    """Make the datasets over (variant, nu) from all batches."""
    from gearmesh.data.datasets import write_datasets

    _remove_other_letters(places, set(study.letters))
    files = [places.batch(letter) for letter in study.letters]
    write_datasets(study, files, places.resonance, places.bifurcation)
    return [places.resonance, places.bifurcation]


def thresholds(study: Study, places: Places) -> list[Path]:
    """Locate the thresholds that the paper states as numbers, by refinement in ν_s."""
    import json

    from gearmesh.data.writing import write_text
    from gearmesh.reproduction.thresholds import locate

    found = locate(study.pair, list(study.variants))
    write_text(places.thresholds, json.dumps(found, indent=1, sort_keys=True) + "\n")
    return [places.thresholds]


def _remove_other_letters(places: Places, letters: set[str]) -> None:
    """Remove what is left of letters that the study had before."""
    import shutil

    for folder in places.cases.glob("*"):
        if folder.is_dir() and folder.name.partition("-")[0] not in letters:
            shutil.rmtree(folder)
    batches, manifests = places.batch("x").parent, places.manifest("x").parent
    for file in (*batches.glob("*"), *manifests.glob("cases-*")):
        if file.stem.rpartition("-")[2] not in letters:
            file.unlink()
