# The pipeline: cases -> datasets -> figures and checks -> ledger -> report -> verdict.
#
#   snakemake                                           the study of the paper
#   snakemake data                                      its cases and datasets only
#   snakemake identify                                  what the paper does not print, inferred
#   snakemake --config study=config/smoke.yaml          another study
#   snakemake --profile workflow/profiles/slurm         on a cluster
#
# This file loads, validates and includes; the rules stand by stage in workflow/rules.
import sys

from snakemake.utils import min_version

from gearmesh.pipeline import job, plan as pipeline
from gearmesh.data import paths
from gearmesh.reproduction.claims import load_ledger
from gearmesh.errors import InputError
from gearmesh.identification import layout
from gearmesh.identification.settings import load_settings

min_version("9.0")

try:
    PLAN = pipeline.load(config, workflow.configfiles)
    LEDGER = load_ledger(paths.CLAIMS)
    DESIGNS = load_settings(layout.SETTINGS)
    KNOWN = {}
    if workflow.is_main_process:
        looks = workflow.output_settings.dryrun or pipeline.only_looks(sys.argv)
        KNOWN = PLAN.look(asked=sys.argv, only_tell=looks or not job.hold_results())
except InputError as error:
    job.tell(f"error: {error}")
    sys.exit(job.BAD_INPUT)

# What runs the scripts is the environment of Snakemake, whatever the PATH is. Neither it nor the
# name of the study is part of a command: both may change without a job having to run again.
shell.prefix(pipeline.prefix(PLAN))


report: "workflow/report/workflow.rst"


localrules:
    all,
    data,
    datasets,
    fig1,
    identified_figures,
    notebook_pages,
    printed,
    ledger,
    report,
    verdict,


rule all:
    input:
        PLAN.batch_files,
        KNOWN.values(),
        paths.VERDICT,


rule data:
    input:
        PLAN.batch_files,
        KNOWN.values(),
        paths.RESONANCE,
        paths.BIFURCATION,


include: "workflow/rules/cases.smk"
include: "workflow/rules/datasets.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/identify.smk"


onstart:
    job.begin_run(len(PLAN.cases))


onsuccess:
    job.tell_summary()


onerror:
    job.tell_summary()
