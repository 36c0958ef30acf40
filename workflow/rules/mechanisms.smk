# What lies behind the response curves: the branches of orbits, with one job for each letter.
rule orbits:
    input:
        again=lambda wildcards: PLAN.again("orbits", wildcards.letter),
    output:
        PLACES.orbits("{letter}"),
    log:
        PLACES.log("orbits-{letter}"),
    benchmark:
        PLACES.benchmark("orbits-{letter}")
    # These jobs take longest, and the notebooks wait for them.
    priority: 2
    params:
        made_of=lambda wildcards: PLAN.made_of("orbits", wildcards.letter),
    shell:
        'python -m gearmesh.pipeline orbits "$STUDY" {params.made_of} {wildcards.letter}'
        " 2>&1 | tee {log}"


rule branches:
    input:
        read=[PLACES.orbits(letter) for letter in PLAN.study.plan.mechanisms.by_letter],
        again=PLAN.again("branches"),
    output:
        PLACES.branches,
        PLACES.special_points,
    log:
        PLACES.log("branches"),
    params:
        made_of=PLAN.made_of("branches"),
    shell:
        'python -m gearmesh.pipeline branches "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


# Of the paper's study alone: its basins, sweeps, exponents and curves of special points.
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
    params:
        made_of=PLAN.made_of("basins"),
    shell:
        'python -m gearmesh.pipeline basins "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


rule sweeps:
    input:
        again=PLAN.again("sweeps"),
    output:
        PLACES.mechanism("sweeps"),
        PLACES.mechanism("design_map"),
    log:
        PLACES.log("sweeps"),
    benchmark:
        PLACES.benchmark("sweeps")
    params:
        made_of=PLAN.made_of("sweeps"),
    shell:
        'python -m gearmesh.pipeline sweeps "$STUDY" {params.made_of} 2>&1 | tee {log}'


rule lyapunov:
    input:
        again=PLAN.again("lyapunov"),
    output:
        PLACES.mechanism("lyapunov"),
    log:
        PLACES.log("lyapunov"),
    benchmark:
        PLACES.benchmark("lyapunov")
    params:
        made_of=PLAN.made_of("lyapunov"),
    shell:
        'python -m gearmesh.pipeline lyapunov "$STUDY" {params.made_of} 2>&1 | tee {log}'


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
    params:
        made_of=PLAN.made_of("special_curves"),
    shell:
        'python -m gearmesh.pipeline special_curves "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
