"""Verify the results of the paper's study; exits 1 if anything does not agree."""

import argparse
import json
import sys
from pathlib import Path

import heyoka

from verification import cases, numbers
from verification.comparison import BOUND, DISPLACEMENT, SENSITIVE
from verification.runs import TOLERANCE
from verification.summary import by_variant, lines, sensitive_cases

STUDY = Path("config/paper.yaml")
RESULTS = Path("results/paper")
PUBLISHED = Path("config/paper.sha256")


def main() -> int:
    """Verify, write ``verification.json``, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m verification", description=__doc__)
    parser.add_argument(
        "--publish", action="store_true", help="write the hashes of the numbers to be committed"
    )
    if parser.parse_args().publish:
        numbers.publish(RESULTS, PUBLISHED)
        return 0
    wanted = cases.of_study(STUDY, RESULTS)
    faults = cases.other_files(wanted, RESULTS)
    compared = [*cases.compare_all(STUDY, wanted)]
    hashes = numbers.compare(RESULTS, PUBLISHED)
    agrees = not faults and hashes.agree and not any(case.faults for case in compared)
    found = {
        "agrees": agrees,
        "cases": len(compared),
        "solver": f"heyoka {heyoka.__version__}, Taylor series, tolerance {TOLERANCE:g}",
        "bound": BOUND,
        "displacement": DISPLACEMENT,
        "sensitive_above": SENSITIVE,
        "datasets": numbers.files(RESULTS),
        "variants": by_variant(compared),
        "sensitive": sensitive_cases(compared),
        "disagreeing": [
            {"variant": case.variant, "nu": case.nu, "faults": case.faults}
            for case in compared
            if case.faults
        ],
        "files": faults,
        "not_compared": sorted({name for case in compared for name in case.unknown}),
        "numbers": hashes.to_dict(),
    }
    text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    (RESULTS / "verification.json").write_text(text, encoding="utf-8")
    print("\n".join(lines(found)))
    return int(not agrees)


if __name__ == "__main__":
    sys.exit(main())
