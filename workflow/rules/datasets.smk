# Put all cases together.
DATASETS = pipeline.script("make_datasets")


rule datasets:
    input:
        sources=pipeline.sources(DATASETS),
        batches=[PLAN.batch_file(batch) for batch in PLAN.batches],
    output:
        str(paths.RESONANCE),
        str(paths.BIFURCATION),
    params:
        recipe=PLAN.recipe,
        grid=PLAN.grid,
    shell:
        "{PYTHON} {DATASETS} {STUDY} {input.batches}"
