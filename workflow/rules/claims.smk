# Put all checks together, and judge.
PRINTED = pipeline.script("check_printed")
COLLECT = pipeline.script("collect_claims")
VERDICT = pipeline.script("give_verdict")


rule printed:
    input:
        pipeline.checked_by("printed", PRINTED),
    output:
        paths.check_file("printed"),
    params:
        recipe=PLAN.recipe,
        claims=pipeline.claims_digest("printed"),
    shell:
        "{PYTHON} {PRINTED} {STUDY}"


rule ledger:
    input:
        sources=pipeline.sources(COLLECT),
        ledger=paths.CLAIMS,
        checks=[paths.check_file(name) for name in paths.CHECKED],
    output:
        report(paths.LEDGER, caption="../report/claims.rst", category="Claims"),
    shell:
        "{PYTHON} {COLLECT} {input.checks}"


rule verdict:
    input:
        pipeline.sources(VERDICT),
        paths.LEDGER,
        paths.REPORT,
    output:
        paths.VERDICT,
    shell:
        "{PYTHON} {VERDICT}"
