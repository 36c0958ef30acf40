# Integrate: a few jobs, each a batch of cases; every case has a declared file of its own.
COMPUTE = pipeline.script("compute_cases")

for batch in PLAN.batches:

    rule:
        name:
            f"cases_{batch.index}"
        input:
            pipeline.sources(COMPUTE),
        output:
            update(PLAN.case_files(batch.cases)),
            batch=PLAN.batch_file(batch),
        log:
            f"results/logs/cases_{batch.index}.log",
        resources:
            mem_mb=1000,
            runtime=30,
        params:
            recipe=PLAN.recipe,
            members=PLAN.members(batch),
            index=batch.index,
        shell:
            "python workflow/scripts/compute_cases.py $STUDY {params.index} 2>&1 | tee {log}"
