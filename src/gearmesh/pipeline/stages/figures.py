"""Draw figures: by notebooks that check their claims too, or without data."""

from pathlib import Path

from gearmesh.data.paths import Places, notebook
from gearmesh.study.cases import Study


def fig1(study: Study, places: Places) -> list[Path]:
    """Draw Fig. 1, the kinematic pair with its symbols: it needs no data."""
    from gearmesh.reproduction.figures import canvas, fig1

    return [*canvas.save(fig1.draw(), places.figure_files("fig1")[0].with_suffix(""))]


def figure(study: Study, places: Places, name: str) -> list[Path]:
    """Run the notebook of a figure: it draws, and checks the claims."""
    from gearmesh.pipeline.notebooks import run_notebook

    png, svg = places.figure_files(name)
    executed, checks = places.executed_notebook(name), places.check(name)
    parameters = {
        "configuration": study.path,
        "resonance": places.resonance,
        "bifurcation": places.bifurcation,
        "thresholds": places.thresholds,
        "cases": places.cases,
        "ledger": study.ledger,
        "figure": png.with_suffix(""),
        "checks": checks,
    }
    run_notebook(notebook(name), executed, parameters, places.scratch)
    return [png, svg, checks, executed]


def identified_figures(study: Study, places: Places) -> list[Path]:
    """Draw the report's figures of the open parameters, as inferred from the claims."""
    from gearmesh.identification import layout, table
    from gearmesh.identification.figures import draw_regions, draw_sensitivity
    from gearmesh.identification.sampling.design import stated
    from gearmesh.identification.settings import load_settings
    from gearmesh.reproduction.figures import canvas

    found, ranges = table.read(), load_settings(layout.SETTINGS).ranges
    drawn = {
        "regions": draw_regions(found["regions"], ranges, stated(study.pair)),
        "sensitivity": draw_sensitivity(found["sensitivity"]),
    }
    files = layout.reported(places)
    return [file for name, drawing in drawn.items() for file in canvas.save(drawing, files[name])]


def study_figures(study: Study, places: Places) -> list[Path]:
    """Draw the response curves and the bifurcation diagram of a study of one's own."""
    from gearmesh.data.datasets import open_dataset
    from gearmesh.report.study_figures import draw_bifurcation, draw_response
    from gearmesh.reproduction.figures import canvas

    drawn = {
        "response": draw_response(open_dataset(places.resonance)),
        "bifurcation": draw_bifurcation(open_dataset(places.bifurcation)),
    }
    return [
        file
        for name, drawing in drawn.items()
        for file in canvas.save(drawing, places.figure_files(name)[0].with_suffix(""))
    ]
