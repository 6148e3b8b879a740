"""`darkflat doctor`: what this machine and bench lack, and how to mend it."""

from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.answering import FAILED, Json, answering
from service.cli.paths import path_option

_SIGNS = {"ok": "[green]✓[/]", "advice": "[yellow]![/]", "missing": "[red]✗[/]"}


def doctor(
    bench: Annotated[
        Path | None,
        path_option(metavar="bench.toml", help="Ask its devices too; the lamps go off"),
    ] = None,
    json: Json = None,
) -> None:
    """Say what this machine and bench have, lack, and how to mend it."""
    with answering(json) as answer:
        from dataclasses import asdict  # noqa: PLC0415

        from service.doctor import examine  # noqa: PLC0415
        from service.settings import Settings  # noqa: PLC0415

        settings = Settings.load()
        found = [asdict(finding) for finding in examine(bench or settings.bench, settings)]
        missing = [each["topic"] for each in found if each["state"] == "missing"]
        content = {"ok": not missing, "missing": missing, "findings": found}
        answer.give(content, lambda console: _show(console, found))
    if missing:
        raise typer.Exit(FAILED)


def _show(console: Any, found: list[dict[str, str]]) -> None:
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    grid = Table.grid(padding=(0, 1))
    grid.add_column(no_wrap=True)
    grid.add_column(no_wrap=True, style="bold")
    grid.add_column(overflow="fold")
    for each in found:
        text = Text(each["text"])
        if each["remedy"]:
            text.append(f"\n{each['remedy']}", style="cyan")
        grid.add_row(_SIGNS[each["state"]], each["topic"], text)
    console.print(grid)
