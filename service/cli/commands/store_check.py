"""`darkflat store check`: is everything there, and as it was?"""

import sys
from typing import TYPE_CHECKING

import typer

from service.cli.answering import FAILED, Json, answering
from service.cli.progress import progress

if TYPE_CHECKING:
    from rich.console import Console

    from service.store.check.check import Checked


def check(json: Json = None) -> None:
    """Find what is missing, altered or left over, and say what to do; nothing is changed.

    Every recording is read to its end. Exit status 1 where something is missing or altered.
    """
    with answering(json) as answer:
        from dataclasses import asdict  # noqa: PLC0415

        from service.settings import Settings  # noqa: PLC0415
        from service.store.check.check import check as look_through  # noqa: PLC0415

        with progress("Checking") as report:
            checked = look_through(Settings.load(), report)
        content = {"whole": checked.is_whole, **asdict(checked)}
        answer.give(content, lambda console: _show(console, checked))
        if not checked.is_whole:
            count = sum(each.kind.is_harm for each in checked.findings)
            print(  # noqa: T201
                f"darkflat: the store is not whole: {count} missing or altered, each of which the"
                " answer explains",
                file=sys.stderr,
            )
            raise typer.Exit(FAILED)


def _show(console: "Console", checked: "Checked") -> None:
    from service.cli.tables import facts, table  # noqa: PLC0415

    facts(
        console,
        {
            "coefficient sets": str(checked.coefficient_sets),
            "recordings": str(checked.recordings),
            "runs": str(checked.runs),
            "audit entries": str(checked.audit_entries),
            "last digest": checked.audit_digest,
        },
    )
    if checked.findings:
        table(console, ("what", "why"), [(each.kind.value, each.text) for each in checked.findings])
