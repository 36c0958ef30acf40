"""Compute what lies behind the response curves: branches of orbits, basins, sweeps and more."""

from pathlib import Path

from gearmesh.data.paths import Places
from gearmesh.study.cases import Mechanisms, Study


def branches(study: Study, places: Places) -> list[Path]:
    """Classify the cases of the study, follow the orbits of its variants, locate special points.

    The special points of periods 1 and 2 are located again without friction and on rigid supports.
    """
    import json

    from gearmesh.data.writing import write_text
    from gearmesh.dynamics.attraction.classification import classify
    from gearmesh.reproduction.mechanisms import files, long_runs, tables
    from gearmesh.reproduction.mechanisms.attractors import (
        all_branches,
        carried_over,
        reached,
    )
    from gearmesh.reproduction.mechanisms.orbits import WITHOUT_SUPPORTS

    limits = float(study.nu[0]), float(study.nu[-1])
    simpler = study.pair.replace(**WITHOUT_SUPPORTS)
    followed, rows, rows_without, runs = {}, [], [], {}
    for name in _mechanisms(study).variants:
        runs[name], ends = reached(study.pair, name, study.nu)
        followed[name] = all_branches(study.pair, name, limits, ends)
        again = all_branches(simpler, name, limits, carried_over(followed[name], simpler))
        rows += tables.rows(name, followed[name], {})
        rows_without += tables.rows(name, again, WITHOUT_SUPPORTS)
    for variant, nus in study.plan.frequencies():
        if variant.name not in runs:
            runs[variant.name] = classify([study.pair.problem(variant, nu) for nu in nus])
    table = tables.table(followed, study.pair.static_deflection)
    files.write(places.branches, table, study, "branches of orbits")
    kinds = long_runs.table(study, runs)
    files.write(places.mechanism("attractors"), kinds, study, "long-run motion of the cases")
    write_text(places.special_points, json.dumps([*rows, *rows_without], indent=1) + "\n")
    return [places.branches, places.special_points, places.mechanism("attractors")]


def basins(study: Study, places: Places) -> list[Path]:
    """Find what the starts and the starting phases of c-• lead to."""
    from gearmesh.data.datasets import open_dataset
    from gearmesh.reproduction.mechanisms import files, starts

    resolution = _mechanisms(study).resolution
    known = open_dataset(places.branches)
    made = starts.basins(study.pair, known, resolution), starts.phases(study.pair, resolution)
    written = [places.mechanism("basins"), places.mechanism("phases")]
    for file, dataset in zip(written, made, strict=True):
        files.write(file, dataset, study, file.stem)
    return written


def ensembles(study: Study, places: Places) -> list[Path]:
    """Measure many long runs: sweeps of ν_s up and down, bands of extrema, Lyapunov exponents.

    None of them needs the orbits. They are one job because each would start the same solver.
    """
    from gearmesh.reproduction.mechanisms import bands, exponents, files, sweeps

    pair, chosen = study.pair, _mechanisms(study)
    damped = [name for name in chosen.variants if name != "a-conservative"]
    made = {
        "sweeps": (sweeps.sweeps(pair, damped), "sweeps up and down"),
        "design_map": (sweeps.design_map(pair, chosen.resolution // 3 + 1), "design map"),
        "bands": (bands.bands(pair, chosen.variants), "bands of extrema"),
        "lyapunov": (exponents.exponents(pair, chosen.resolution), "Lyapunov exponents"),
    }
    for name, (dataset, title) in made.items():
        files.write(places.mechanism(name), dataset, study, title)
    return [places.mechanism(name) for name in made]


def special_curves(study: Study, places: Places) -> list[Path]:
    """Follow special points over ν_s and the damping, and over ν_s and the damping length."""
    import json

    from gearmesh.reproduction.mechanisms import curves, files

    rows = json.loads(places.special_points.read_text(encoding="utf-8"))
    found = curves.curves(study.pair, rows)
    files.write(places.mechanism("special_curves"), found, study, "curves of special points")
    return [places.mechanism("special_curves")]


def why(study: Study, places: Places) -> list[Path]:
    """Run the notebook that draws what lies behind the curves."""
    from gearmesh.data.paths import WHY, notebook
    from gearmesh.pipeline.notebooks import run_notebook

    executed = places.executed_notebook(WHY)
    parameters = {
        "configuration": study.path,
        "datasets": places.branches.parent,
        "figures": places.figure_files(WHY)[0].parent,
    }
    run_notebook(notebook(WHY), executed, parameters, places.scratch)
    return [*places.why_files, executed]


def _mechanisms(study: Study) -> Mechanisms:
    assert study.plan.mechanisms is not None  # without them there are no such rules
    return study.plan.mechanisms
