"""Cases a second of the pipeline, and of the plain layout with one job for each case.

Run from the root of the project: ``python -m benchmarks.pipeline_layout``. Both run under
Snakemake on two cores in a folder of their own, on a sample of the study of the paper: the plain
layout on few cases, since each of its jobs takes the same time. Compiled code is there before.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
COPIED = (
    *("Snakefile", "config", "docs", "notebooks", "profiles", "src", "workflow"),
    *("CITATION.cff", "requirements.lock"),
)
CORES = "2"
PLAIN_CASES = 24

SAMPLE = """\
base: paper.yaml
title: A sample
variants: [a-conservative, b-material, c-lubricant, c-material, d-both, h-material]
strong_damping: null
time_courses: null
"""

PLAIN = """\
CASES = [f"plain/nu-{{0.6 + 0.025 * i:.4f}}.nc" for i in range({count})]

rule all:
    input: CASES

rule case:
    output: "plain/nu-{{nu}}.nc"
    shell:
        "{python} -m gearmesh simulate --config config/paper.yaml --variant c-material"
        " --nu {{wildcards.nu}} -o {{output}} > /dev/null"
"""


def main() -> None:
    """Measure both and print the ratio."""
    with tempfile.TemporaryDirectory(prefix="layout-") as name:
        folder = Path(name)
        copy_project(folder)
        (folder / "config" / "sample.yaml").write_text(SAMPLE)
        (folder / "Plain").write_text(PLAIN.format(count=PLAIN_CASES, python=sys.executable))
        run(folder, "-s", "Plain", "plain/nu-0.6000.nc")  # compiles where that is needed
        shutil.rmtree(folder / "plain")
        plain = PLAIN_CASES / run(folder, "-s", "Plain")
        seconds = run(folder, "--config", "study=config/sample.yaml", "--", "data")
        count = sum(1 for _ in (folder / "results" / "sample" / "cases").rglob("*.nc"))
        print(f"one job a case: {plain:.2f} cases a second ({PLAIN_CASES} cases)")
        print(f"batches:        {count / seconds:.0f} cases a second ({count} cases, datasets too)")
        print(f"ratio:          {count / seconds / plain:.0f}")


def copy_project(folder: Path) -> None:
    """Copy what the pipeline needs, with what is compiled."""
    for part in COPIED:
        source = ROOT / part
        copy = shutil.copytree if source.is_dir() else shutil.copy2
        copy(source, folder / part)


def run(folder: Path, *arguments: str) -> float:
    """Run Snakemake; returns the seconds that it took."""
    environment = os.environ | {"PYTHONPATH": str(folder / "src")}
    command = [sys.executable, "-m", "snakemake", "--cores", CORES, *arguments]
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
