"""The jobs of the pipeline: each public function is a stage, and returns the files that it wrote.

A stage imports within its body what only it needs. A job therefore starts quickly, and runs again
only if something that it uses changes (`gearmesh.data.provenance.code_digest`).
"""

from gearmesh.pipeline.stages import (
    cases,
    claims,
    crate,
    datasets,
    figures,
    identify,
    mechanisms,
    report,
)

STAGES = {
    stage.__name__: stage
    for stage in (
        *(cases.cases, cases.case, datasets.datasets, datasets.thresholds),
        *(figures.fig1, figures.figure, figures.identified_figures, figures.study_figures),
        *(mechanisms.branches, mechanisms.basins, mechanisms.ensembles),
        *(mechanisms.special_curves, mechanisms.why),
        *(claims.printed, claims.ledger, claims.verdict),
        *(
            report.notebook_pages,
            report.explorer,
            report.report,
            report.hashes,
        ),
        crate.crate,
        *(identify.samples, identify.box, identify.all_samples, identify.identified),
        identify.identification_notebook,
    )
}
"""All stages, by their names."""


def job_name(stage: str, *arguments: str) -> str:
    """Return the name of a job, which is also that of its manifest, log and benchmark."""
    return "-".join((stage, *arguments))
