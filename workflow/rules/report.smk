# The report: its page, the notebooks as pages beside it, and two figures of its own.
localrules:
    identified_figures,
    notebook_pages,
    report,


rule identified_figures:
    input:
        again=PLAN.again("identified_figures"),
    output:
        [f"{path}{end}" for path in layout.reported(PLACES).values() for end in (".png", ".svg")],
    log:
        PLACES.log("identified_figures"),
    benchmark:
        PLACES.benchmark("identified_figures")
    # As fig1.
    priority: 2
    params:
        made_of=PLAN.made_of("identified_figures"),
    shell:
        'python -m gearmesh.pipeline identified_figures "$STUDY" {params.made_of} 2>&1 | tee {log}'


SHOWN = [*paths.NOTEBOOK_NAMES, *([paths.WHY] if PLAN.study.plan.mechanisms else [])]


rule notebook_pages:
    input:
        notebooks=expand(PLACES.executed_notebook("{name}"), name=SHOWN),
        again=PLAN.again("notebook_pages"),
    output:
        expand(PLACES.notebook_page("{name}"), name=SHOWN),
    log:
        PLACES.log("notebook_pages"),
    benchmark:
        PLACES.benchmark("notebook_pages")
    params:
        made_of=PLAN.made_of("notebook_pages"),
    shell:
        'python -m gearmesh.pipeline notebook_pages "$STUDY" {params.made_of} --read {input.notebooks}'
        " 2>&1 | tee {log}"


rule report:
    input:
        read=[PLACES.ledger, PLACES.resonance],
        shown=[
            rules.figures.input,
            rules.identified_figures.output,
            rules.notebook_pages.output,
            PLACES.of_why if PLAN.study.plan.mechanisms else [],
        ],
        beside=rules.explorer.output,
        again=PLAN.again("report"),
    output:
        report(PLACES.report, caption="../report/page.rst", category="Report"),
    log:
        PLACES.log("report"),
    benchmark:
        PLACES.benchmark("report")
    params:
        made_of=PLAN.made_of("report"),
    shell:
        'python -m gearmesh.pipeline report "$STUDY" {params.made_of} --read {input.read} {input.shown}'
        " 2>&1 | tee {log}"
