"""`statistics.csv`: what is left of a recording whose frames are gone."""

import math
from dataclasses import dataclass
from pathlib import Path

from calib.errors import InputError
from calib.recording.conditions_csv import read_rows

REQUIRED = ("block", "samples", "mean_dn", "variance_dn2")


@dataclass(frozen=True)
class StatisticsRow:
    """One row: what is known of a block.

    Attributes:
        block: The block's name.
        samples: How many samples the figures are from.
        mean_dn: Mean code.
        variance_dn2: Temporal variance; None where unknown.
    """

    block: str
    samples: int
    mean_dn: float
    variance_dn2: float | None


def read_statistics(path: Path, blocks: tuple[str, ...]) -> tuple[StatisticsRow, ...]:
    """Return the rows in their order; InputError where one names no block of `blocks`."""
    _, rows = read_rows(path, REQUIRED)
    return tuple(
        _row(row, f"{path}, row {number}", blocks) for number, row in enumerate(rows, start=2)
    )


def _row(row: dict[str, str], where: str, blocks: tuple[str, ...]) -> StatisticsRow:
    if row["block"] not in blocks:
        raise InputError(
            f"{where}: block {row['block']} has no row in conditions.csv: add it",
            code="block-not-found",
        )
    try:
        variance = float(row["variance_dn2"]) if row["variance_dn2"] else None
        parsed = StatisticsRow(row["block"], int(row["samples"]), float(row["mean_dn"]), variance)
    except ValueError as error:
        raise InputError(f"{where}: {error}: correct it", code="statistics-invalid") from error
    numbers = (parsed.mean_dn, parsed.variance_dn2 or 0.0)
    if parsed.samples < 1 or not all(math.isfinite(n) and n >= 0 for n in numbers):
        raise InputError(
            f"{where}: samples must be 1 or more, mean and variance finite and not negative",
            code="statistics-invalid",
        )
    return parsed
