# Execute the notebooks: each draws a figure and checks its claims.
NOTEBOOK = pipeline.script("run_notebook")
FIG1 = pipeline.script("draw_fig1")
THRESHOLDS = pipeline.script("locate_thresholds")

# Variants whose time courses a figure shows.
SHOWN = {
    "fig4": ["c-lubricant"],
    "fig5": ["c-material"],
    "fig6": ["c-material", "c-material-5x"],
    "fig7": ["c-material", "c-material-5x"],
}
STYLE = "src/gearmesh/reproduction/figures/gearmesh.mplstyle"
LOOKS = [STYLE, "src/gearmesh/report/templates/claims.html.j2"]


rule thresholds:
    input:
        pipeline.sources(THRESHOLDS),
    output:
        str(paths.THRESHOLDS),
    log:
        "results/logs/thresholds.log",
    # All figures wait for it, and it compiles code of its own: it goes first.
    priority: 3
    params:
        recipe=PLAN.recipe,
        variants=PLAN.variants,
    shell:
        'python workflow/scripts/locate_thresholds.py "$STUDY" 2>&1 | tee {log}'


rule fig1:
    input:
        pipeline.sources(FIG1),
        STYLE,
    output:
        report(paths.FIGURES / "fig1.png", caption="../report/fig1.rst", category="Figures"),
        paths.FIGURES / "fig1.svg",
    log:
        "results/logs/fig1.log",
    # It needs nothing that is computed: it fills the time that others wait for compiled code.
    priority: 2
    shell:
        "python workflow/scripts/draw_fig1.py {output} 2>&1 | tee {log}"


for figure in paths.NOTEBOOK_NAMES:

    rule:
        name:
            figure
        input:
            LOOKS,
            sources=pipeline.checked_by(figure, NOTEBOOK, str(paths.notebook(figure))),
            notebook=paths.notebook(figure),
            resonance=paths.RESONANCE,
            bifurcation=paths.BIFURCATION,
            thresholds=paths.THRESHOLDS,
            courses=PLAN.time_courses(SHOWN.get(figure, [])),
        output:
            png=report(
                paths.FIGURES / f"{figure}.png",
                caption=f"../report/{figure}.rst",
                category="Figures",
            ),
            svg=paths.FIGURES / f"{figure}.svg",
            checks=paths.check_file(figure),
        log:
            paths.executed_notebook(figure),
        params:
            recipe=PLAN.recipe,
            claims=pipeline.claims_digest(LEDGER, figure),
            ledger=str(paths.CLAIMS),
        shell:
            'python workflow/scripts/run_notebook.py {input.notebook} {log} configuration="$STUDY"'
            " resonance={input.resonance} bifurcation={input.bifurcation}"
            " thresholds={input.thresholds} cases=results/cases ledger={params.ledger}"
            " figure={output.png} checks={output.checks}"
