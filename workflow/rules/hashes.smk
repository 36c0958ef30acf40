# One file with the hashes of all results, for `sha256sum -c`.
rule hashes:
    input:
        read=[
            PLACES.resonance,
            PLACES.bifurcation,
            PLACES.report,
            PLACES.explorer,
            expand(PLACES.batch("{letter}"), letter=LETTERS),
            [PLACES.branches, PLACES.special_points] if PLAN.study.plan.mechanisms else [],
        ],
        again=PLAN.again("hashes"),
    output:
        PLACES.hashes,
    log:
        PLACES.log("hashes"),
    params:
        made_of=PLAN.made_of("hashes"),
    shell:
        'python -m gearmesh.pipeline hashes "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
