# Where the results come from: inputs, parameters, jobs, and the hashes of all files.
localrules:
    crate,


rule crate:
    input:
        read=[
            PLACES.resonance,
            PLACES.bifurcation,
            PLACES.report,
            PLACES.explorer,
            expand(PLACES.batch("{letter}"), letter=LETTERS),
            [PLACES.branches, PLACES.special_points] if PLAN.study.plan.mechanisms else [],
        ],
        again=PLAN.again("crate"),
    output:
        PLACES.crate,
    log:
        PLACES.log("crate"),
    params:
        made_of=PLAN.made_of("crate"),
    shell:
        'python -m gearmesh.pipeline crate "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"
