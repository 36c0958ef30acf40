"""Change the code in small ways, one at a time, and count which changes the tests notice.

    python .ci/mutants.py [--every N] [TARGET ...]

A mutant changes one comparison, operator, constant, condition or returned value. Its tests run in a
process that is forked from this one, so that libraries are imported once. A mutant is killed when
a test fails, or when the tests take far too long. Survivors are printed; docs/testing.md says why
each of them is harmless. Compiled code is not mutated: numba would compile it again for each
mutant, and two other solvers check it anyway.
"""

import argparse
import ast
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

TARGETS = {
    "model": (
        ["model/*.py"],
        [
            "tests/model tests/interface/test_geometry.py",
            "tests/study tests/solvers/test_series.py",
        ],
    ),
    "measures": (
        ["reproduction/claims/*.py"],
        ["tests/reproduction/test_ledger.py tests/reproduction/test_claims.py"],
    ),
    "layout": (
        ["data/casefile.py", "data/manifest.py", "data/paths.py"],
        ["tests/data/test_paths.py tests/data/test_casefile.py tests/data/test_manifest.py"],
    ),
    "reruns": (
        ["pipeline/plan.py", "data/provenance.py", "pipeline/inputs.py"],
        ["tests/pipeline tests/data/test_code_digest.py"],
    ),
}
"""Files below src/gearmesh, and the tests that should notice a change in them.

The second group runs for the survivors of the first. It compiles the solvers of each mutant.
"""

LIMIT = 300
"""Seconds after which the tests of a mutant count as hanging, and the mutant as killed."""

SWAPS = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
ROOT = Path(__file__).parents[1]


def places(tree: ast.AST) -> Iterator[tuple[ast.AST, str, int]]:
    """Yield what can be changed: a node, the field in it, and the index in that field.

    Decorators are left alone: whether a class is frozen or has slots changes no result.
    """
    decorators = [d for node in ast.walk(tree) for d in getattr(node, "decorator_list", [])]
    spared = {part for decorator in decorators for part in ast.walk(decorator)}
    for node in ast.walk(tree):
        if node in spared:
            continue
        if isinstance(node, ast.Compare):
            yield from ((node, "ops", i) for i, op in enumerate(node.ops) if type(op) in SWAPS)
        elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in SWAPS:
            yield node, "op", 0
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
            yield node, "value", 0
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
            yield node, "unary", 0
        elif isinstance(node, ast.Return) and node.value is not None:
            yield node, "return", 0


def mutated(source: str, number: int) -> tuple[str, str]:
    """Return the source with its change of that number, and the line as it was."""
    tree = ast.parse(source)
    node, field, index = list(places(tree))[number]
    line = source.splitlines()[node.lineno - 1].strip()
    if field == "ops":
        node.ops[index] = SWAPS[type(node.ops[index])]()
    elif field == "op":
        node.op = SWAPS[type(node.op)]()
    elif field == "value":
        node.value = not node.value if isinstance(node.value, bool) else node.value + 1
    elif field == "unary":
        node.op = ast.UAdd() if isinstance(node.op, ast.USub) else ast.Not()
        if isinstance(node.op, ast.Not):
            node.operand = ast.UnaryOp(ast.Not(), node.operand)
    else:
        node.value = ast.Constant(None)
    return ast.unparse(tree), f"{node.lineno}: {line} [{type(node).__name__} {field}]"


def survives(folder: Path, tests: str) -> bool:
    """Run tests with the package of a folder, in a forked process."""
    child = os.fork()
    if not child:
        os.setsid()
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        sys.path.insert(0, str(folder))
        os.environ["PYTHONPATH"] = str(folder)
        sys.dont_write_bytecode = True
        signal.alarm(LIMIT)
        import pytest

        options = ["-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
        os._exit(int(pytest.main([*options, *tests.split()])) != 0)
    return os.waitpid(child, 0)[1] == 0


def main() -> int:
    """Run all mutants of the targets; fails if fewer than nine of ten are killed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*", choices=[[], *TARGETS], default=[*TARGETS])
    parser.add_argument("--every", type=int, default=1, help="run each N-th mutant only")
    options = parser.parse_args()
    os.chdir(ROOT)
    _load_libraries()
    total = killed = 0
    with tempfile.TemporaryDirectory() as temporary:
        source = Path(shutil.copytree("src", f"{temporary}/src"))
        for target in options.targets:
            patterns, tests = TARGETS[target]
            if not all(survives(source, group) for group in tests):
                print(f"{target}: the tests fail without any change")
                return 1
            files = sorted(f for p in patterns for f in (source / "gearmesh").glob(p))
            count = dead = 0
            for file in files:
                text = file.read_text(encoding="utf-8")
                for number in range(0, len([*places(ast.parse(text))]), options.every):
                    changed, what = mutated(text, number)
                    file.write_text(changed, encoding="utf-8")
                    alive = all(survives(source, group) for group in tests)
                    count, dead = count + 1, dead + (not alive)
                    if alive:
                        print(f"survives: {file.relative_to(source)}:{what}", flush=True)
                file.write_text(text, encoding="utf-8")
            print(f"{target}: {dead} of {count} killed", flush=True)
            total, killed = total + count, killed + dead
    print(f"all: {killed} of {total} killed, {killed / total:.1%}")
    return int(killed < 0.9 * total)


def _load_libraries() -> None:
    import netCDF4  # noqa: F401
    import numba  # noqa: F401
    import pint  # noqa: F401
    import pydantic  # noqa: F401
    import pytest  # noqa: F401
    import scipy.integrate
    import scipy.optimize  # noqa: F401
    import xarray  # noqa: F401


if __name__ == "__main__":
    sys.exit(main())
