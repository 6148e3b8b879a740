"""How commands print numbers and tables."""

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text


def number(value: float | None, digits: int = 4) -> str:
    """Return a number with so many significant digits; a dash where it is not known."""
    return "–" if value is None else f"{value:.{digits}g}"


def with_std(value: float | None, std: float | None) -> str:
    """Return `value ± std`, the value to the decimals of its uncertainty's second digit."""
    if value is None or std is None or not std > 0:
        return number(value)
    decimals = max(0, 1 - int(f"{std:.1e}".partition("e")[2]))
    return f"{value:.{decimals}f} ± {std:.{decimals}f}"


def facts(console: Console, rows: Mapping[str, str]) -> None:
    """Print names and values in two columns; values are never cut."""
    width = max(len(name) for name in rows)
    for name, value in rows.items():
        console.print(Text.assemble((name.ljust(width), "bold"), "  ", value))


def table(console: Console, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table; cells are plain text, whatever they hold."""
    made = Table(box=None, header_style="bold", pad_edge=False)
    for name in head:
        made.add_column(name, overflow="fold")
    for row in rows:
        made.add_row(*(Text(cell) for cell in row))
    console.print(made)
