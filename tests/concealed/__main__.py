"""`python -m tests.concealed`: draw recordings, diagnose them, open the answers, measure."""

import argparse
import subprocess
import sys
from pathlib import Path

from tests.concealed.generator.suite import SIZES, suite
from tests.concealed.scoring.figures import draw_all
from tests.concealed.scoring.outcome import outcomes
from tests.concealed.scoring.run import run
from tests.concealed.scoring.summary import as_markdown, claims
from tests.concealed.scoring.visibility import visible_in


def main() -> int:
    """Run what is left of the suite, then score it; 1 where a claim is missed with --strict."""
    arguments = _arguments()
    cases = suite(arguments.origin, SIZES[arguments.size])[: arguments.first or None]
    run(cases, arguments.diagnose, arguments.out, workers=arguments.workers)
    visible = visible_in(cases, arguments.out, workers=arguments.workers)
    every = list(outcomes(arguments.out, visible))
    table = as_markdown(every)
    (arguments.out / "table.md").write_text(table, encoding="utf-8")
    draw_all(every, arguments.out / "figures")
    print(f"key, opened: {(arguments.out / 'key.hex').read_text('utf-8')}")
    print(table)
    missed = any(claim.reached is False for claim in claims(every))
    return 1 if arguments.strict and missed else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.concealed", description=__doc__)
    add = parser.add_argument
    add("--origin", default=None, help="what seeds follow from; this commit's hash if not given")
    add("--size", choices=sorted(SIZES), default="part")
    add("--diagnose", default="tests.concealed.scoring.by_command:diagnose",
        metavar="MODULE:FUNCTION", help="a recording's folder in, an answer out")  # fmt: skip
    add("--out", type=Path, default=Path("proof"), help="the run's folder; a run is resumed there")
    add("--workers", type=int, default=2)
    add("--first", type=int, default=0, metavar="N", help="only the suite's first N cases")
    add("--strict", action="store_true", help="exit with status 1 where a claim is missed")
    arguments = parser.parse_args()
    arguments.origin = arguments.origin or _commit()
    return arguments


def _commit() -> str:
    command = ["git", "rev-parse", "HEAD"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
