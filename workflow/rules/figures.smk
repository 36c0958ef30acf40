# Execute the notebooks: each draws a figure and checks its claims.
localrules:
    fig1,
    figures,


rule thresholds:
    input:
        again=PLAN.again("thresholds"),
    output:
        PLACES.thresholds,
    log:
        PLACES.log("thresholds"),
    benchmark:
        PLACES.benchmark("thresholds")
    # This job goes first, because all figures wait for it and it compiles code of its own.
    priority: 3
    params:
        made_of=PLAN.made_of("thresholds"),
    shell:
        'python -m gearmesh.pipeline thresholds "$STUDY" {params.made_of} 2>&1 | tee {log}'


rule fig1:
    input:
        again=PLAN.again("fig1"),
    output:
        report(
            PLACES.figure_files("fig1")[0],
            caption="../report/fig1.rst",
            category="Figures",
        ),
        PLACES.figure_files("fig1")[1],
    log:
        PLACES.log("fig1"),
    benchmark:
        PLACES.benchmark("fig1")
    # This job needs no results, so it runs while other jobs wait for compiled code.
    priority: 2
    params:
        made_of=PLAN.made_of("fig1"),
    shell:
        'python -m gearmesh.pipeline fig1 "$STUDY" {params.made_of} 2>&1 | tee {log}'


rule figure:
    input:
        read=[PLACES.resonance, PLACES.bifurcation, PLACES.thresholds],
        again=lambda wildcards: PLAN.again("figure", wildcards.figure),
    output:
        png=report(
            PLACES.figure_files("{figure}")[0],
            caption="../report/figure.rst",
            category="Figures",
        ),
        svg=PLACES.figure_files("{figure}")[1],
        checks=PLACES.check("{figure}"),
    log:
        PLACES.executed_notebook("{figure}"),
    benchmark:
        PLACES.benchmark("figure-{figure}")
    params:
        made_of=lambda wildcards: PLAN.made_of("figure", wildcards.figure),
    shell:
        'python -m gearmesh.pipeline figure "$STUDY" {params.made_of} {wildcards.figure}'
        " --read {input.read}"


rule figures:
    input:
        [PLACES.figure_files(name) for name in paths.FIGURE_NAMES],
