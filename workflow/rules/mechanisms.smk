# What lies behind the response curves: the branches of orbits, with one job for each letter.
localrules:
    branches,


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
