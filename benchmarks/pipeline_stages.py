"""Where the time of the pipeline goes, and what a rerun without work takes.

Run from the root of the project: ``python -m benchmarks.pipeline_stages [STUDY [TARGET]]``; the
study of the paper and everything, if none is named. In a folder of its own, on two cores: a run
with compiled code cold, the same again with it warm, and reruns that find nothing to do. Stages
are told in processor time, which other work on the machine disturbs least, and of the cold run;
compilation is what the jobs that integrate take more of it there.
"""

import json
import os
import resource
import shutil
import statistics
import sys
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.pipeline_layout import PROFILE, copy_project, run

RERUNS = 5
INTEGRATING = ("integration", "ledger")
"""Stages that compile; the ledger integrates for the printed numbers."""


def main() -> None:
    """Measure and print."""
    study, target = [*sys.argv[1:], *["config/paper.yaml", "all"][len(sys.argv) - 1 :]]
    arguments = (*PROFILE, "--config", f"study={study}", "--", target)
    with tempfile.TemporaryDirectory(prefix="stages-") as name:
        folder = Path(name)
        copy_project(folder)
        for compiled in folder.rglob("__pycache__"):
            shutil.rmtree(compiled)
        cold, cold_processor = measured(folder, *arguments)
        spent = stages(folder / "results" / ".journal")
        for results in ("results", ".snakemake"):
            shutil.rmtree(folder / results)
        warm, warm_processor = measured(folder, *arguments)
        repeated = stages(folder / "results" / ".journal")
        spent["Snakemake"] = cold_processor - spent.total()
        for stage in INTEGRATING:
            spent["compilation"] += spent[stage] - repeated[stage]
            spent[stage] = repeated[stage]
        reruns = [measured(folder, *arguments)[0] for _ in range(RERUNS)]
        files = [file for file in (folder / "results").rglob("*") if file.is_file()]
        disk = sum(file.stat().st_blocks for file in files) * 512
        memory = max(line.get("megabytes", 0) for line in journal(folder / "results" / ".journal"))

    print(f"{study}, {target}; load of the machine before: {os.getloadavg()[2]:.1f}")
    print(f"compiled code cold: {cold:.0f} s elapsed, {cold_processor:.0f} s of processor time")
    print(f"compiled code warm: {warm:.0f} s elapsed, {warm_processor:.0f} s of processor time")
    for stage, seconds in spent.most_common():
        print(f"  {stage:28} {seconds:6.1f} s  {seconds / cold_processor:4.0%}")
    other = 1.0 - (spent["integration"] + spent["notebooks"]) / cold_processor
    compilation = spent["compilation"] / cold_processor
    print(f"neither integration nor notebooks: {other:.0%} of the processor time;")
    print(f"  that share of the elapsed time is {other * cold:.0f} s;")
    print(f"  with compilation as part of the integration {other - compilation:.0%}")
    print(f"nothing to do: {statistics.median(reruns):.1f} s ({min(reruns):.1f} at the least)")
    print(f"{len(files)} files, {disk / 1e6:.0f} MB; memory of a job at most {memory:.0f} MB")


def measured(folder: Path, *arguments: str) -> tuple[float, float]:
    """Run; returns the elapsed and the processor time."""
    before = _processor()
    elapsed = run(folder, *arguments)
    return elapsed, _processor() - before


def _processor() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def journal(path: Path) -> list[dict]:
    """Read the journal of the run."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def stages(path: Path) -> Counter:
    """Return the processor time of everything that the jobs did."""
    spent = Counter()
    for line in journal(path):
        if "part" in line:
            name = "starts and imports" if line["part"] == "loading" else line["part"]
            spent[name] += line["processor"]
            spent["cases, the rest"] -= line["processor"]
        elif "stage" in line:
            spent["starts and imports"] += line["loading"]
            name = {"cases": "cases, the rest", "figures": "notebooks", "thresholds": "integration"}
            stage = name.get(line["stage"], line["stage"])
            spent[stage] += line["processor"] - line["loading"]
    return spent


if __name__ == "__main__":
    main()
