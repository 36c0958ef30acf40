# Infer the parameters that the paper does not print. The samples of the open parameters are
# computed in batches; a focused design fills a box around the best samples of the designs before
# it. Nothing here is part of the default target, which reads the committed table
# config/identified.yaml.
localrules:
    box,
    identify,


DESIGNS = PLAN.designs.designs
FOCUSED = [name for name, design in DESIGNS.items() if design.around]


rule samples:
    input:
        read=lambda wildcards: (
            layout.box_file(PLACES, wildcards.design) if wildcards.design in FOCUSED else []
        ),
        again=lambda wildcards: PLAN.again("samples", wildcards.design, wildcards.index),
    output:
        layout.batch_file(PLACES, "{design}", "{index}"),
    log:
        PLACES.log("samples-{design}-{index}"),
    benchmark:
        PLACES.benchmark("samples-{design}-{index}")
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        made_of=lambda wildcards: PLAN.made_of("samples", wildcards.design, wildcards.index),
    shell:
        'python -m gearmesh.pipeline samples "$STUDY" {params.made_of} {wildcards.design}'
        " {wildcards.index} --read {input.read} 2>&1 | tee {log}"


rule box:
    input:
        read=lambda wildcards: layout.batch_files(
            PLACES,
            PLAN.designs,
            *layout.family(PLAN.designs, DESIGNS[wildcards.design].around),
        ),
        again=lambda wildcards: PLAN.again("box", wildcards.design),
    output:
        layout.box_file(PLACES, "{design}"),
    log:
        PLACES.log("box-{design}"),
    wildcard_constraints:
        design="|".join(FOCUSED),
    params:
        made_of=lambda wildcards: PLAN.made_of("box", wildcards.design),
    shell:
        'python -m gearmesh.pipeline box "$STUDY" {params.made_of} {wildcards.design}'
        " --read {input.read} 2>&1 | tee {log}"


rule all_samples:
    input:
        read=layout.batch_files(PLACES, PLAN.designs, *DESIGNS),
        again=PLAN.again("all_samples"),
    output:
        layout.dataset(PLACES),
    log:
        PLACES.log("all_samples"),
    params:
        made_of=PLAN.made_of("all_samples"),
    shell:
        'python -m gearmesh.pipeline all_samples "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


rule identified:
    input:
        read=[layout.dataset(PLACES), *(layout.box_file(PLACES, name) for name in FOCUSED)],
        again=PLAN.again("identified"),
    output:
        layout.found(PLACES),
    log:
        PLACES.log("identified"),
    params:
        made_of=PLAN.made_of("identified"),
    shell:
        'python -m gearmesh.pipeline identified "$STUDY" {params.made_of} --read {input.read}'
        " 2>&1 | tee {log}"


rule identification_notebook:
    input:
        read=[layout.found(PLACES), layout.dataset(PLACES)],
        again=PLAN.again("identification_notebook"),
    output:
        layout.figure_files(PLACES),
    log:
        PLACES.executed_notebook("identification"),
    params:
        made_of=PLAN.made_of("identification_notebook"),
    shell:
        'python -m gearmesh.pipeline identification_notebook "$STUDY" {params.made_of}'
        " --read {input.read}"


rule identify:
    input:
        layout.found(PLACES),
        layout.figure_files(PLACES),
