# Put all cases together.
localrules:
    datasets,


rule datasets:
    input:
        batches=expand(PLACES.batch("{letter}"), letter=LETTERS),
        again=PLAN.again("datasets"),
    output:
        PLACES.resonance,
        PLACES.bifurcation,
    log:
        PLACES.log("datasets"),
    benchmark:
        PLACES.benchmark("datasets")
    params:
        made_of=PLAN.made_of("datasets"),
    shell:
        'python -m gearmesh.pipeline datasets "$STUDY" {params.made_of} --read {input.batches}'
        " 2>&1 | tee {log}"
