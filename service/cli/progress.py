"""Progress on standard error, with the time left; lines instead of a bar where nobody looks."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[float, str], None]
"""Take the share that is done, 0 to 1, and what goes on now."""

_LINE_EVERY_S = 10.0


@contextmanager
def progress(title: str) -> Iterator[Report]:
    """Give a function that shows how far `title` is; it knows the time left by itself."""
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
        TimeRemainingColumn,
    )

    from service.cli.consoles import notes  # noqa: PLC0415

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        TextColumn("[dim]{task.fields[doing]}"),
    )
    with Progress(*columns, console=notes(), transient=True) as bar:
        task = bar.add_task(title, total=1.0, doing="")
        yield lambda share, doing: bar.update(task, completed=share, doing=doing)


def _lines(title: str) -> Report:
    """Return what prints a line now and then: for logs."""
    began = last = time.monotonic()

    def report(share: float, doing: str) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < _LINE_EVERY_S or not 0 < share < 1:
            return
        last = now
        left_s = (now - began) * (1 - share) / share
        print(f"{title}: {share:.0%}, {left_s:.0f} s left; {doing}", file=sys.stderr)  # noqa: T201

    return report
