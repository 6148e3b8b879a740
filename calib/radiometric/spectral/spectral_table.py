"""Tables of numbers in CSV files: a header line of names with units, then rows.

Spectra, scans and certificates come in this form. `#` starts a line of comment.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import InputError


@dataclass(frozen=True)
class Table:
    """A CSV file's cells as text, by the column's name; `path` for messages."""

    path: Path
    cells: dict[str, list[str]]

    @property
    def names(self) -> tuple[str, ...]:
        """The columns' names in the order of the file."""
        return tuple(self.cells)

    def text(self, name: str) -> list[str]:
        """Return a column's cells as they are; empty ones where the column is not there."""
        return self.cells.get(name, [""] * self.n_rows)

    @property
    def n_rows(self) -> int:
        """How many rows there are below the header."""
        return len(next(iter(self.cells.values())))

    def numbers(self, name: str, *, empty: float | None = None) -> Columns:
        """Return a column's numbers, (n_rows,).

        Args:
            name: Its name.
            empty: What an empty cell (or a column that is not there) stands for; an error if None.

        Raises:
            InputError: `bad-number`: a cell is not a finite number.
        """
        return np.array([self._number(name, row, empty) for row in range(self.n_rows)], np.float64)

    def _number(self, name: str, row: int, empty: float | None) -> float:
        cell = self.text(name)[row]
        if not cell and empty is not None:
            return empty
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            msg = f"{self.path}, row {row + 1}: {name} is {cell!r}; give a finite number."
            raise InputError(msg, code="bad-number")
        return value


def read_table(path: Path, required: Sequence[str], optional: Sequence[str] | None = ()) -> Table:
    """Return the table in `path`.

    Args:
        path: The CSV file.
        required: Columns that must be there.
        optional: Columns that may be there; any where None.

    Raises:
        InputError: `not-found`, `unreadable`, `missing-column`, `unknown-column` or `empty-table`.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [row for row in csv.reader(file) if any(row) and not row[0].startswith("#")]
    except FileNotFoundError as error:
        raise InputError(f"{path} is missing: add it.", code="not-found") from error
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path} cannot be read as CSV: {error}.", code="unreadable") from error
    header = [name.strip() for name in rows[0]] if rows else []
    if len(rows) < 2:
        raise InputError(f"{path} has no rows below a header: fill it.", code="empty-table")
    _check_header(path, header, required, optional)
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(header):
            msg = f"{path}, row {number} has {len(row)} cells, its header {len(header)}: mend it."
            raise InputError(msg, code="unreadable")
    columns = zip(*rows[1:], strict=True)
    return Table(
        path, {n: [cell.strip() for cell in c] for n, c in zip(header, columns, strict=True)}
    )


def _check_header(
    path: Path, header: list[str], required: Sequence[str], optional: Sequence[str] | None
) -> None:
    """Raise InputError where a column is missing, there twice or not known."""
    for name in required:
        if name not in header:
            msg = f"{path} has no column {name}: add it (its columns are {', '.join(header)})."
            raise InputError(msg, code="missing-column")
    for name in header:
        unknown = optional is not None and name not in {*required, *optional}
        if unknown or header.count(name) > 1:
            msg = f"{path} has a column {name!r} that is not known or there twice: mend it."
            raise InputError(msg, code="unknown-column")


def check_positive(table: Table, name: str, values: Columns, *, zero: bool = False) -> None:
    """Raise InputError `out-of-range` where a number is negative, or 0 unless `zero` is allowed."""
    bad = np.flatnonzero((values < 0) | ((values == 0) & (not zero)))
    if len(bad):
        msg = f"{table.path}, row {bad[0] + 1}: {name} is {values[bad[0]]:g}; it must be positive."
        raise InputError(msg, code="out-of-range")


def sorted_by_wavelength(table: Table, wavelength_nm: Columns) -> NDArray[np.intp]:
    """Return the rows' order by wavelength; InputError `wavelength-twice` where two agree."""
    check_positive(table, "wavelength_nm", wavelength_nm)
    order = np.argsort(wavelength_nm, kind="stable")
    same = np.flatnonzero(np.diff(wavelength_nm[order]) <= 0)
    if len(same):
        msg = f"{table.path} states {wavelength_nm[order][same[0]]:g} nm twice: keep one."
        raise InputError(msg, code="wavelength-twice")
    return order
