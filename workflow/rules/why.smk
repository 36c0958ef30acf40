# Why it jumps: basins, sweeps, exponents and curves of special points of the paper's pair, and the
# notebook that draws them.
rule basins:
    input:
        read=[PLACES.branches],
        again=PLAN.again("basins"),
    output:
        PLACES.mechanism("basins"),
        PLACES.mechanism("phases"),
    log:
        PLACES.log("basins"),
    benchmark:
        PLACES.benchmark("basins")
    # The notebook waits for this job, and the figures can be drawn beside the notebook.
    priority: 2
    params:
        made_of=PLAN.made_of("basins"),
    shell:
        'python -m gearmesh.pipeline basins "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


# What long runs show by themselves, without the orbits.
rule ensembles:
    input:
        again=PLAN.again("ensembles"),
    output:
        PLACES.mechanism("sweeps"),
        PLACES.mechanism("design_map"),
        PLACES.mechanism("bands"),
        PLACES.mechanism("lyapunov"),
    log:
        PLACES.log("ensembles"),
    benchmark:
        PLACES.benchmark("ensembles")
    # The notebook waits for this job, and the figures can be drawn beside the notebook.
    priority: 2
    params:
        made_of=PLAN.made_of("ensembles"),
    shell:
        'python -m gearmesh.pipeline ensembles "$STUDY" {params.made_of} 2>&1 | tee {log}'


rule special_curves:
    input:
        read=[PLACES.special_points],
        again=PLAN.again("special_curves"),
    output:
        PLACES.mechanism("special_curves"),
    log:
        PLACES.log("special_curves"),
    benchmark:
        PLACES.benchmark("special_curves")
    # The notebook waits for this job, and the figures can be drawn beside the notebook.
    priority: 2
    params:
        made_of=PLAN.made_of("special_curves"),
    shell:
        'python -m gearmesh.pipeline special_curves "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


rule why:
    input:
        read=[
            PLACES.branches,
            PLACES.special_points,
            PLACES.bifurcation,
            [PLACES.mechanism(name) for name in paths.MECHANISMS],
        ],
        again=PLAN.again("why"),
    output:
        PLACES.why_files,
    log:
        PLACES.executed_notebook(paths.WHY),
    benchmark:
        PLACES.benchmark("why")
    # This notebook takes longest, so others are run beside it.
    priority: 2
    params:
        made_of=PLAN.made_of("why"),
    shell:
        'python -m gearmesh.pipeline why "$STUDY" {params.made_of} --read {input.read}'
