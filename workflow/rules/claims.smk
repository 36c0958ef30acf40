# Collect all checks, and compare them with the ledger.
localrules:
    printed,
    ledger,
    verdict,


rule printed:
    input:
        again=PLAN.again("printed"),
    output:
        PLACES.check("printed"),
    log:
        PLACES.log("printed"),
    benchmark:
        PLACES.benchmark("printed")
    params:
        made_of=PLAN.made_of("printed"),
    shell:
        'python -m gearmesh.pipeline printed "$STUDY" {params.made_of} 2>&1 | tee {log}'


rule ledger:
    input:
        checks=expand(PLACES.check("{name}"), name=paths.CHECKED),
        orbits=([PLACES.special_points, PLACES.thresholds] if PLAN.study.plan.mechanisms else []),
        again=PLAN.again("ledger"),
    output:
        report(PLACES.ledger, caption="../report/claims.rst", category="Claims"),
        PLACES.verdict,
    log:
        PLACES.log("ledger"),
    params:
        made_of=PLAN.made_of("ledger"),
    shell:
        'python -m gearmesh.pipeline ledger "$STUDY" {params.made_of} --read {input.checks} {input.orbits}'
        " 2>&1 | tee {log}"


# The last job: it fails if a claim has another status than the ledger expects.
rule verdict:
    input:
        read=[PLACES.ledger, PLACES.verdict, PLACES.report, PLACES.hashes],
        again=PLAN.again("verdict"),
    output:
        PLACES.as_expected,
    log:
        PLACES.log("verdict"),
    params:
        made_of=PLAN.made_of("verdict"),
    shell:
        'python -m gearmesh.pipeline verdict "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
