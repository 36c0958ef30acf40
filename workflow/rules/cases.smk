# Integrate the cases, with one job for each letter of Tab. 1. The job also writes a file for each
# case, and its manifest names them all. Snakemake would take longer for thousands of declared
# files than the cases take.
rule cases:
    input:
        again=lambda wildcards: PLAN.again("cases", wildcards.letter),
    output:
        PLACES.batch("{letter}"),
    log:
        PLACES.log("cases-{letter}"),
    benchmark:
        PLACES.benchmark("cases-{letter}")
    priority: 1
    resources:
        mem_mb=1000,
        runtime=30,
    params:
        made_of=lambda wildcards: PLAN.made_of("cases", wildcards.letter),
    shell:
        'python -m gearmesh.pipeline cases "$STUDY" {params.made_of} {wildcards.letter}'
        " 2>&1 | tee {log}"


# A case file that is requested by its name. If its letter is up to date, the file exists already.
rule case:
    input:
        lambda wildcards: ancient(PLACES.batch(wildcards.variant[0])),
    output:
        PLACES.case("{variant}", "{nu}"),
    log:
        PLACES.log("case-{variant}-{nu}"),
    shell:
        'python -m gearmesh.pipeline case "$STUDY" - {wildcards.variant} {wildcards.nu}'
        " 2>&1 | tee {log:q}"


use rule case as case_by_whole_path with:
    output:
        f"{{root}}/{PLACES.case('{variant}', '{nu}')}",
    log:
        f"{{root}}/{PLACES.log('case-{variant}-{nu}')}",
