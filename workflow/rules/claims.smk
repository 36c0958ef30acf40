# Put all checks together, and judge.
PRINTED = pipeline.script("check_printed")
COLLECT = pipeline.script("collect_claims")
VERDICT = pipeline.script("give_verdict")


rule printed:
    input:
        pipeline.checked_by("printed", PRINTED),
    output:
        paths.check_file("printed"),
    log:
        "results/logs/printed.log",
    params:
        recipe=PLAN.recipe,
        claims=pipeline.claims_digest(LEDGER, "printed"),
    shell:
        'python workflow/scripts/check_printed.py "$STUDY" 2>&1 | tee {log}'


rule ledger:
    input:
        sources=pipeline.sources(COLLECT),
        ledger=paths.CLAIMS,
        checks=[paths.check_file(name) for name in paths.CHECKED],
    output:
        report(paths.LEDGER, caption="../report/claims.rst", category="Claims"),
    log:
        "results/logs/ledger.log",
    shell:
        "python workflow/scripts/collect_claims.py {input.checks} 2>&1 | tee {log}"


rule verdict:
    input:
        pipeline.sources(VERDICT),
        paths.LEDGER,
        paths.REPORT,
    output:
        paths.VERDICT,
    log:
        "results/logs/verdict.log",
    shell:
        "python workflow/scripts/give_verdict.py 2>&1 | tee {log}"
