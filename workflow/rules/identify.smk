# Infer what the paper does not print: samples of the open parameters, in batches; focused designs
# fill a box around the best of what came before. Nothing here is part of the default target, which
# reads the committed table config/identified.yaml.
from gearmesh.data import provenance
from gearmesh.identification.design import left_alone

MEASURE = pipeline.script("identify_batch")
BOX = pipeline.script("identify_box")
GATHER = pipeline.script("identify_dataset")
INFER = pipeline.script("identify_parameters")
RUN = pipeline.script("run_notebook")


for name, stated in DESIGNS.designs.items():

    rule:
        name:
            f"identify_{name}"
        input:
            pipeline.sources(MEASURE),
            layout.box_file(name) if stated.around else [],
        output:
            layout.FOLDER / name / r"batch-{index,\d+}.nc",
        log:
            f"results/logs/identify_{name}_{{index}}.log",
        resources:
            mem_mb=1500,
            runtime=30,
        params:
            recipe=left_alone(stated, PLAN.study.pair),
            versions=str(provenance.versions()),
            settings=str(layout.SETTINGS),
            stated=DESIGNS.sampling(name),
            design=name,
        shell:
            'python workflow/scripts/identify_batch.py {params.settings} "$STUDY" {params.design}'
            " {wildcards.index} {output} 2>&1 | tee {log}"

    if stated.around:

        rule:
            name:
                f"identify_{name}_box"
            input:
                pipeline.sources(BOX),
                paths.CLAIMS,
                batches=layout.batch_files(DESIGNS, *layout.family(DESIGNS, stated.around)),
            output:
                layout.box_file(name),
            log:
                f"results/logs/identify_{name}_box.log",
            params:
                settings=str(layout.SETTINGS),
                stated=DESIGNS.sampling(name),
                design=name,
            shell:
                "python workflow/scripts/identify_box.py {params.settings} {params.design}"
                " {input.batches} 2>&1 | tee {log}"


rule identification_dataset:
    input:
        sources=pipeline.sources(GATHER),
        batches=layout.batch_files(DESIGNS, *DESIGNS.designs),
    output:
        layout.DATASET,
    log:
        "results/logs/identification_dataset.log",
    shell:
        "python workflow/scripts/identify_dataset.py {input.batches} 2>&1 | tee {log}"


rule identified:
    input:
        pipeline.sources(INFER),
        paths.CLAIMS,
        layout.DATASET,
        [layout.box_file(name) for name, stated in DESIGNS.designs.items() if stated.around],
        settings=layout.SETTINGS,
    output:
        layout.FOUND,
    log:
        "results/logs/identified.log",
    shell:
        "python workflow/scripts/identify_parameters.py {input.settings} 2>&1 | tee {log}"


rule identification_notebook:
    input:
        sources=pipeline.sources("notebooks/identification.ipynb", RUN),
        table=layout.FOUND,
        samples=layout.DATASET,
        ledger=paths.CLAIMS,
        settings=layout.SETTINGS,
    output:
        [layout.FIGURES / f"{name}.png" for name in layout.FIGURE_NAMES],
        [layout.FIGURES / f"{name}.svg" for name in layout.FIGURE_NAMES],
    log:
        layout.NOTEBOOK,
    params:
        recipe=PLAN.recipe,
    shell:
        "python workflow/scripts/run_notebook.py notebooks/identification.ipynb {log}"
        ' configuration="$STUDY" table={input.table} samples={input.samples}'
        " ledger={input.ledger} settings={input.settings}"


rule identify:
    input:
        layout.FOUND,
        [layout.FIGURES / f"{name}.svg" for name in layout.FIGURE_NAMES],
