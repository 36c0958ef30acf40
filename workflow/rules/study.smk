# A study of one's own, without a ledger of claims: its figures and its report.
localrules:
    study_figures,
    figures,
    report,


rule study_figures:
    input:
        read=[PLACES.resonance, PLACES.bifurcation],
        again=PLAN.again("study_figures"),
    output:
        PLACES.figure_files("response"),
        PLACES.figure_files("bifurcation"),
    log:
        PLACES.log("study_figures"),
    benchmark:
        PLACES.benchmark("study_figures")
    params:
        made_of=PLAN.made_of("study_figures"),
    shell:
        'python -m gearmesh.pipeline study_figures "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


rule figures:
    input:
        PLACES.figure_files("response"),
        PLACES.figure_files("bifurcation"),


rule report:
    input:
        read=[PLACES.resonance, rules.figures.input],
        beside=rules.explorer.output,
        again=PLAN.again("report"),
    output:
        PLACES.report,
    log:
        PLACES.log("report"),
    benchmark:
        PLACES.benchmark("report")
    params:
        made_of=PLAN.made_of("report"),
    shell:
        'python -m gearmesh.pipeline report "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
