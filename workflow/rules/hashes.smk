# One file with the hashes of all results, for `sha256sum -c`.
localrules:
    hashes,


rule hashes:
    input:
        read=[rules.crate.input.read, PLACES.crate],
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
