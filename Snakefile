# The pipeline: Tab. 1 -> cases -> datasets -> figures and checks -> ledger -> report -> verdict.
#
#   snakemake                                        the study of the paper
#   snakemake data                                   its cases and datasets only
#   snakemake identify                               what the paper does not print, inferred
#   snakemake --config study=config/smoke.yaml       another study
#   snakemake --profile profiles/slurm               on a cluster
#
# This file loads, checks and includes; the rules are in workflow/rules, a file for each stage.
import os
import re
import sys

from snakemake.utils import min_version

from gearmesh.data import paths
from gearmesh.errors import InputError
from gearmesh.garbage import search_rarely
from gearmesh.identification import layout
from gearmesh.pipeline import locks, plan as pipeline
from gearmesh.pipeline.messages import BAD_INPUT, say

min_version("9.0")
search_rarely()

try:
    PLAN = pipeline.load(
        workflow.config_settings.config, workflow.configfiles, workflow.is_main_process
    )
except InputError as error:
    say(f"error: {error}")
    sys.exit(BAD_INPUT)

PLACES = PLAN.places
LETTERS = list(PLAN.letters)

# The stages run in the environment of Snakemake, whatever the PATH is. Neither this environment nor
# the file of the study is part of a command, so both may change without a rerun of the jobs.
shell.prefix(pipeline.prefix(PLAN))


report: "workflow/report/workflow.rst"


wildcard_constraints:
    letter="[a-z]",
    figure="|".join(paths.NOTEBOOK_NAMES),
    variant="|".join(PLAN.study.variants).replace(".", r"\."),
    design="|".join(PLAN.designs.designs),
    index=r"\d+",
    root=re.escape(os.getcwd()),


# Short rules run where Snakemake runs, also on a cluster; each file of rules names its own.
localrules:
    all,
    data,


rule all:
    input:
        PLACES.resonance,
        PLACES.report,
        PLACES.hashes,
        PLACES.crate,
        PLACES.as_expected if PLAN.study.claims else [],
        [PLACES.branches, PLACES.special_points] if PLAN.study.plan.mechanisms else [],


rule data:
    input:
        expand(PLACES.batch("{letter}"), letter=LETTERS),
        PLACES.resonance,
        PLACES.bifurcation,


include: "workflow/rules/cases.smk"
include: "workflow/rules/datasets.smk"
include: "workflow/rules/explorer.smk"


if PLAN.study.plan.mechanisms:

    include: "workflow/rules/mechanisms.smk"


if PLAN.study.claims:

    include: "workflow/rules/figures.smk"
    include: "workflow/rules/claims.smk"
    include: "workflow/rules/report.smk"

    if PLAN.study.plan.mechanisms:

        include: "workflow/rules/why.smk"

else:

    include: "workflow/rules/study.smk"


include: "workflow/rules/identify.smk"
include: "workflow/rules/crate.smk"
include: "workflow/rules/hashes.smk"


onstart:
    locks.begin_run(PLACES)


onsuccess:
    locks.end_run(PLACES)


onerror:
    locks.end_run(PLACES)
