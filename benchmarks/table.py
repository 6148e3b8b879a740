"""The table as a terminal shows it, and as Markdown takes it."""

from collections.abc import Sequence

from rich.table import Table

from benchmarks.race import Figure
from benchmarks.row import Row

HEADINGS = ("work", "ours", "NumPy", "peer", "limit", "to reach", "reached")


def table(rows: Sequence[Row]) -> Table:
    """Return the table for a terminal."""
    shown = Table(*HEADINGS, show_lines=True)
    for row in rows:
        shown.add_row(*_cells(row))
    return shown


def markdown(rows: Sequence[Row]) -> str:
    """Return the table in Markdown, a line for each row."""
    lines = [HEADINGS, ("---",) * len(HEADINGS), *(_cells(row) for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _cells(row: Row) -> tuple[str, ...]:
    """Return the row's cells, in the order of the headings."""
    peers = [f"{name} {_beside(figure)}" for name, figure in row.peers.items()]
    limit = f"{_number(row.limit.rate)} ({row.limit_is}); ours is {row.limit.ours_is:.2f} of it"
    return (
        row.work,
        "; ".join((f"{_number(row.ours)} {row.unit}", *row.notes)),
        "-" if row.numpy is None else _beside(row.numpy),
        "; ".join(peers) or "-",
        limit,
        row.bound,
        "yes" if row.reached else "no",
    )


def _beside(figure: Figure) -> str:
    return f"{_number(figure.rate)} (ours {_number(figure.ours_is)} x)"


def _number(value: float) -> str:
    """Return two to three digits, or all before the point."""
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.1f}" if abs(value) >= 10 else f"{value:.2f}"
