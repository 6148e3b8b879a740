"""`python -m benchmarks`: measure, and print one table."""

import argparse
import json
import sys
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path

from rich.console import Console

from benchmarks.catalogue import ROWS
from benchmarks.row import Row
from benchmarks.size import Size
from benchmarks.table import markdown, table

_WIDTH = 160


def main() -> int:
    """Run the rows that are asked for; return the exit status."""
    arguments = _arguments()
    size = Size(peers=arguments.peers, folder=arguments.folder)
    if arguments.quick:
        size = replace(size, recording_s=5.0, rounds=5)
    done = {}
    for name in arguments.rows or ROWS:
        print(f"measuring {name} …", file=sys.stderr, flush=True)
        done[name] = ROWS[name](size)
    _print(done, arguments)
    return 1 if arguments.strict and not all(row.reached for row in done.values()) else 0


def _print(done: Mapping[str, Row], arguments: argparse.Namespace) -> None:
    rows = list(done.values())
    if arguments.json is not None:
        text = json.dumps({name: asdict(row) for name, row in done.items()}, indent=2)
        if arguments.json == "-":
            print(text)
            return
        Path(arguments.json).write_text(text + "\n", encoding="utf-8")
    if arguments.markdown:
        print(markdown(rows))
    else:
        Console(width=_WIDTH).print(table(rows))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    add = parser.add_argument
    add("rows", nargs="*", metavar="ROW", help=f"only these: {', '.join(ROWS)}")
    add("--quick", action="store_true", help="record for 5 s instead of 30, and take fewer turns")
    add("--json", metavar="FILE", help="write the figures there; - prints them and nothing else")
    add("--markdown", action="store_true", help="print the table in Markdown")
    add("--peers", type=Path, metavar="PYTHON", help="the peers' Python; without it, no peers")
    add("--folder", type=Path, help="where recordings are put for a while: up to 8 GB")
    add("--strict", action="store_true", help="exit with status 1 where a bound is missed")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.rows if name not in ROWS]
    if unknown:
        parser.error(f"there is no row {', '.join(unknown)}; there are {', '.join(ROWS)}")
    return arguments


if __name__ == "__main__":
    sys.exit(main())
