# Put all cases together.
DATASETS = pipeline.script("make_datasets")


rule datasets:
    input:
        sources=pipeline.sources(DATASETS),
        batches=PLAN.batch_files,
    output:
        str(paths.RESONANCE),
        str(paths.BIFURCATION),
    log:
        "results/logs/datasets.log",
    params:
        recipe=PLAN.recipe,
        grid=PLAN.grid,
    shell:
        'python workflow/scripts/make_datasets.py "$STUDY" {input.batches} 2>&1 | tee {log}'
