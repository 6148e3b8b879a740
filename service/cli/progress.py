"""Progress on standard error, with the time left; lines instead of a bar where nobody looks."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Literal, Protocol

Left = float | Literal["by share"] | None
"""Seconds; None where nobody knows yet; "by share" where work goes on as fast as it began."""

_LINE_EVERY_S = 10.0


class Report(Protocol):
    """What is told how far the work is."""

    def __call__(self, share: float, doing: str, left: Left = "by share") -> None:
        """Take the share that is done, 0 to 1, what goes on now, and the time left."""


@contextmanager
def progress(title: str) -> Iterator[Report]:
    """Give a function that shows how far `title` is."""
    if sys.stderr.isatty():
        with _bar(title) as report:
            yield report
    else:
        yield _lines(title)


def share_of(report: Report, doing: str = "") -> Callable[[float], None]:
    """Return `report` for work that tells only the share that is done."""
    return lambda share: report(share, doing)


@contextmanager
def _bar(title: str) -> Iterator[Report]:
    from rich.progress import (  # noqa: PLC0415  (0.1 s that `--help` does not need)
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
    )

    from service.cli.consoles import notes  # noqa: PLC0415
    from service.cli.time_left_column import TimeLeftColumn  # noqa: PLC0415

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeLeftColumn(),
        TextColumn("[dim]{task.fields[doing]}"),
    )
    with Progress(*columns, console=notes(), transient=True) as bar:
        task = bar.add_task(title, total=1.0, doing="", until_s="by share")

        def report(share: float, doing: str, left: Left = "by share") -> None:
            until_s = time.monotonic() + left if isinstance(left, float) else left
            bar.update(task, completed=share, doing=doing, until_s=until_s)

        yield report


def _lines(title: str) -> Report:
    """Return what prints a line now and then: for logs."""
    began = last = time.monotonic()

    def report(share: float, doing: str, left: Left = "by share") -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < _LINE_EVERY_S or not 0 < share < 1:
            return
        last = now
        left_s = (now - began) * (1 - share) / share if left == "by share" else left
        told = "" if left_s is None else f" {left_s:.0f} s left;"
        print(f"{title}: {share:.0%};{told} {doing}", file=sys.stderr)  # noqa: T201

    return report
