# The report: its page, the notebooks as pages beside it, and the captions of `snakemake --report`.

from gearmesh.identification.design import stated

REPORT = pipeline.script("build_report")
SHOW = pipeline.script("show_notebooks")
IDENTIFIED = pipeline.script("draw_identified")


rule identified_figures:
    input:
        pipeline.sources(IDENTIFIED),
        STYLE,
        [layout.IDENTIFIED, layout.SETTINGS],
    output:
        [f"{path}{suffix}" for path in layout.REPORTED.values() for suffix in (".png", ".svg")],
    log:
        "results/logs/identified_figures.log",
    # As fig1.
    priority: 2
    params:
        shown=str(stated(PLAN.study.pair)),
    shell:
        'python workflow/scripts/draw_identified.py "$STUDY" 2>&1 | tee {log}'


rule notebook_pages:
    input:
        sources=pipeline.sources(SHOW),
        template="src/gearmesh/report/templates/notebook.html.j2",
        notebooks=[paths.executed_notebook(name) for name in paths.NOTEBOOK_NAMES],
    output:
        [paths.notebook_page(name) for name in paths.NOTEBOOK_NAMES],
    log:
        "results/logs/notebook_pages.log",
    shell:
        "python workflow/scripts/show_notebooks.py 2>&1 | tee {log}"


rule report:
    input:
        sources=pipeline.sources(REPORT),
        templates=pipeline.templates(),
        captions=pipeline.captions(),
        identified=[layout.IDENTIFIED, layout.SETTINGS, paths.CLAIMS],
        ledger=paths.LEDGER,
        resonance=paths.RESONANCE,
        shown=[
            [file for name in paths.FIGURE_NAMES for file in paths.figure_files(name)],
            rules.identified_figures.output,
            rules.notebook_pages.output,
        ],
    output:
        report(paths.REPORT, caption="../report/page.rst", category="Report"),
    log:
        "results/logs/report.log",
    params:
        study=PLAN.stated,
    shell:
        'python workflow/scripts/build_report.py "$STUDY" 2>&1 | tee {log}'
