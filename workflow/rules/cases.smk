# Integrate: a few jobs, each a batch of cases. Thousands of declared files would cost more than
# the cases: Snakemake knows of the batch files, and of case files only what it has to (see
# `Plan.look`).
COMPUTE = pipeline.script("compute_cases")

for batch in PLAN.batches:

    rule:
        name:
            f"cases_{batch.index}"
        input:
            pipeline.sources(COMPUTE),
        output:
            PLAN.batch_file(batch),
            KNOWN.get(batch.index, []),
        log:
            f"results/logs/cases_{batch.index}.log",
        priority: 1
        resources:
            mem_mb=1000,
            runtime=30,
        params:
            recipe=PLAN.recipe,
            members=PLAN.members(batch),
            index=batch.index,
        shell:
            'python workflow/scripts/compute_cases.py "$STUDY" {params.index} 2>&1 | tee {log}'
