"""Where the time of the pipeline goes, and what a rerun without work takes.

Run from the root of the project: ``python -m benchmarks.pipeline_stages [STUDY [TARGET]]``; the
study of the paper and everything, if none is named. In a folder of its own, on two cores: a run
with compiled code cold, the same again with it warm, and reruns that find nothing to do. The time
and memory of each job are those that Snakemake measured.
"""

import csv
import os
import resource
import shutil
import statistics
import sys
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.pipeline_layout import copy_project, run

RERUNS = 5


def main() -> None:
    """Measure and print."""
    study, target = [*sys.argv[1:], *["config/paper.yaml", "all"][len(sys.argv) - 1 :]]
    arguments = ("--config", f"study={study}", "--", target)
    with tempfile.TemporaryDirectory(prefix="stages-") as name:
        folder = Path(name)
        copy_project(folder)
        for compiled in folder.rglob("__pycache__"):
            shutil.rmtree(compiled)
        cold, cold_processor = measured(folder, *arguments)
        for results in ("results", ".snakemake"):
            shutil.rmtree(folder / results)
        warm, warm_processor = measured(folder, *arguments)
        spent, memory = stages(folder)
        spent["Snakemake, short jobs"] = warm_processor - spent.total()
        reruns = [measured(folder, *arguments)[0] for _ in range(RERUNS)]
        files = [file for file in (folder / "results").rglob("*") if file.is_file()]
        disk = sum(file.stat().st_blocks for file in files) * 512

    print(f"{study}, {target}; load of the machine before: {os.getloadavg()[2]:.1f}")
    print(f"compiled code cold: {cold:.0f} s elapsed, {cold_processor:.0f} s of processor time")
    print(f"compiled code warm: {warm:.0f} s elapsed, {warm_processor:.0f} s of processor time")
    for stage, seconds in spent.most_common():
        print(f"  {stage:28} {seconds:6.1f} s  {seconds / warm_processor:4.0%}")
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


def stages(folder: Path) -> tuple[Counter, float]:
    """Return the processor time of each stage, and the greatest memory of a job in MB."""
    spent, memory = Counter(), 0.0
    for path in folder.glob("results/*/benchmarks/*.tsv"):
        [row] = csv.DictReader(path.open(), delimiter="\t")
        if row["cpu_time"] != "NA":  # of a job too short to be measured
            spent[path.stem.partition("-")[0]] += float(row["cpu_time"])
            memory = max(memory, float(row["max_rss"]))
    return spent, memory


if __name__ == "__main__":
    main()
