# The report page, and the captions of `snakemake --report`.

REPORT = pipeline.script("build_report")


rule report:
    input:
        sources=pipeline.sources(REPORT),
        templates=pipeline.templates(),
        captions=pipeline.captions(),
        identified=[layout.IDENTIFIED, layout.SETTINGS, paths.CLAIMS],
        ledger=paths.LEDGER,
        resonance=paths.RESONANCE,
        figures=[file for name in paths.FIGURE_NAMES for file in paths.figure_files(name)],
        notebooks=[paths.executed_notebook(name) for name in paths.NOTEBOOK_NAMES],
    output:
        report(paths.REPORT, caption="../report/page.rst", category="Report"),
        [paths.notebook_page(name) for name in paths.NOTEBOOK_NAMES],
        [f"{path}{suffix}" for path in layout.REPORTED.values() for suffix in (".png", ".svg")],
    log:
        "results/logs/report.log",
    params:
        study=PLAN.stated,
    shell:
        'python workflow/scripts/build_report.py "$STUDY" 2>&1 | tee {log}'
