"""Radiance by level, from a table."""

import csv
from pathlib import Path

from calib.errors import InputError, reason_of


def read_radiances(path: Path) -> dict[float, float]:
    """Return radiance by level from a CSV with the columns `level` and `radiance`.

    Raises:
        InputError: `radiances-unreadable`, which names the row.
    """
    radiances: dict[float, float] = {}
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file, skipinitialspace=True)
            for row in rows:
                _take(radiances, row, f"{path}, line {rows.line_num}")
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = reason_of(error)
        msg = f"{path} cannot be read ({reason}): give a table in UTF-8 with `level,radiance`"
        raise InputError(msg, code="radiances-unreadable") from error
    if not radiances:
        msg = f"{path} has no rows; give `level,radiance` and a row for each level"
        raise InputError(msg, code="radiances-unreadable")
    return radiances


def _take(radiances: dict[float, float], row: dict[str, str], where: str) -> None:
    try:
        level, radiance = float(row["level"]), float(row["radiance"])
    except (KeyError, TypeError, ValueError) as error:
        msg = f"{where} does not give a level and a radiance as numbers; write `level,radiance`"
        raise InputError(msg, code="radiances-unreadable") from error
    if level in radiances:
        msg = f"{where} gives level {level:g} a second radiance; keep one"
        raise InputError(msg, code="radiances-unreadable")
    radiances[level] = radiance
