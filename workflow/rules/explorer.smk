# The explorer: a page beside the report with the numbers of the study, and a solver.
localrules:
    explorer,


rule explorer:
    input:
        read=[
            PLACES.resonance,
            PLACES.bifurcation,
            [PLACES.branches, PLACES.special_points] if PLAN.study.plan.mechanisms else [],
        ],
        again=PLAN.again("explorer"),
    output:
        report(PLACES.explorer, caption="../report/explorer.rst", category="Report"),
    log:
        PLACES.log("explorer"),
    benchmark:
        PLACES.benchmark("explorer")
    params:
        made_of=PLAN.made_of("explorer"),
    shell:
        'python -m gearmesh.pipeline explorer "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
