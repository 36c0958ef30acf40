"""What the server of `python_process` has done once it has imported this, so no run does it.

Half of the time that Snakemake takes to plan a study of the tests is to search for its plugins and
to parse the same sources of gearmesh.
"""

import ast
import functools
import sys
from pathlib import Path

from snakemake.cli import get_argument_parser

ROOT = Path(__file__).parents[1]

get_argument_parser()  # it registers the plugins

ast.parse = functools.cache(ast.parse)
for file in (ROOT / "src").rglob("*.py"):
    ast.parse(file.read_text(encoding="utf-8"))

sys.path.remove(str(Path(__file__).parent))  # a run has the modules of its copy only
