"""Infer from the claims the parameters that the paper does not print."""

from pathlib import Path
from typing import Any

from gearmesh.data.paths import CLAIMS, Places
from gearmesh.pipeline.messages import say
from gearmesh.study.cases import Study


def samples(study: Study, places: Places, design: str, index: str) -> list[Path]:
    """Measure the claims on one batch of samples of the open parameters."""
    import warnings

    from gearmesh.identification import layout
    from gearmesh.identification.sampling import boxes, store
    from gearmesh.identification.sampling.design import unit_points
    from gearmesh.identification.sampling.survey import compute
    from gearmesh.identification.settings import load_settings

    # A quantity that exists nowhere has the median not-a-number, as intended.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    settings = load_settings(layout.SETTINGS)
    stated = settings.designs[design]
    points = unit_points(stated)
    if stated.around:
        points = boxes.read_box(layout.box_file(places, design)).fill(points)
    found = compute(settings, study.pair, design, int(index), points)
    file = layout.batch_file(places, design, int(index))
    store.write(file, found, f"claims on samples of the design {design}")
    say(f"{design}: batch {int(index) + 1} of {layout.batch_count(settings, design)}")
    return [file]


def box(study: Study, places: Places, design: str) -> list[Path]:
    """Find the box that the best samples before a focused design span."""
    from gearmesh.identification import layout
    from gearmesh.identification.estimation import focus
    from gearmesh.identification.sampling import boxes, store
    from gearmesh.identification.sampling.survey import tested_claims
    from gearmesh.identification.settings import load_settings
    from gearmesh.reproduction.claims import load_ledger

    settings = load_settings(layout.SETTINGS)
    stated = settings.designs[design]
    assert stated.around is not None  # a box belongs to a focused design
    before = layout.batch_files(places, settings, *layout.family(settings, stated.around))
    tested = [claim for claim in load_ledger(CLAIMS) if claim.id in tested_claims()]
    file = layout.box_file(places, design)
    boxes.write_box(file, focus.around(store.read(*before), stated, tested), stated)
    return [file]


def all_samples(study: Study, places: Places) -> list[Path]:
    """Put all samples of the open parameters together."""
    from gearmesh.identification import layout
    from gearmesh.identification.sampling import store
    from gearmesh.identification.settings import load_settings

    settings = load_settings(layout.SETTINGS)
    file = layout.dataset(places)
    store.write_all(file, layout.batch_files(places, settings, *settings.designs))
    return [file]


def identified(study: Study, places: Places) -> list[Path]:
    """Infer the open parameters from all samples, and check the inference on itself."""
    from gearmesh.identification import layout, table
    from gearmesh.identification.estimation.analysis import Analysis
    from gearmesh.identification.estimation.findings import findings
    from gearmesh.identification.sampling import boxes, store
    from gearmesh.identification.sampling.survey import tested_claims
    from gearmesh.identification.settings import load_settings
    from gearmesh.reproduction.claims import load_ledger

    settings = load_settings(layout.SETTINGS)
    focused = [name for name, design in settings.designs.items() if design.around]
    analysis = Analysis(
        samples=store.read(layout.dataset(places)),
        boxes={name: boxes.read_box(layout.box_file(places, name)) for name in focused},
        ledger=[claim for claim in load_ledger(CLAIMS) if claim.id in tested_claims()],
        settings=settings,
    )
    found: dict[str, Any] = findings(analysis)
    table.write(layout.found(places), found)
    recovery = found["recovery"]
    say(f"synthetic papers: {recovery['recovered']} of {recovery['papers']} recovered")
    return [layout.found(places)]


def identification_notebook(study: Study, places: Places) -> list[Path]:
    """Run the notebook of the identification, which draws its figures."""
    from gearmesh.data.paths import notebook
    from gearmesh.identification import layout
    from gearmesh.pipeline.notebooks import run_notebook

    executed = places.executed_notebook("identification")
    parameters = {
        "configuration": study.path,
        "settings": layout.SETTINGS,
        "ledger": CLAIMS,
        "table": layout.found(places),
        "samples": layout.dataset(places),
        "figures": layout.figures(places),
    }
    run_notebook(notebook("identification"), executed, parameters, places.scratch)
    return [executed, *layout.figure_files(places)]
