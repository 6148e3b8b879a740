"""Reads a monochromator scan: a folder of CSV files (docs/spectral-response.md).

scan.csv        the camera's signals by wavelength and incidence angle, with their darks
reference.csv   the reference photodiode's current before and after each angle's scan
photodiode.csv  its responsivity in A/W, with the certificate's uncertainty
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.arrays import Columns
from calib.errors import InputError
from calib.radiometric.spectral.spectral_response_frames import mean_signal
from calib.radiometric.spectral.spectral_table import (
    Table,
    check_positive,
    read_table,
    sorted_by_wavelength,
)

_SCAN = ("wavelength_nm", "angle_deg", "time_s", "exposure_us")
_SIGNAL = ("signal_dn", "signal_dn_std", "dark_dn", "dark_dn_std")
_FRAMES = ("frame", "dark_frame", "first_column", "last_column")


@dataclass(frozen=True)
class ScanTable:
    """One row per wavelength and angle, each (n_rows,).

    `signal_dn` has its dark subtracted; `signal_dn_std` holds both uncertainties.
    """

    wavelength_nm: Columns
    angle_deg: Columns
    time_s: Columns
    exposure_us: Columns
    signal_dn: Columns
    signal_dn_std: Columns


@dataclass(frozen=True)
class ReferenceTable:
    """The photodiode's readings, each (n_rows,); currents with their dark current subtracted.

    `angle_deg` is NaN in a reading that serves all angles; `after` tells after from before.
    """

    wavelength_nm: Columns
    angle_deg: Columns
    time_s: Columns
    current_a: Columns
    current_a_std: Columns
    after: Columns


@dataclass(frozen=True)
class Photodiode:
    """The reference's responsivity, straight between its points, each (n,)."""

    wavelength_nm: Columns
    responsivity_a_per_w: Columns
    responsivity_a_per_w_std: Columns

    @classmethod
    def load(cls, path: Path) -> "Photodiode":
        """Read photodiode.csv; its std is a certificate's, an error of type B (k = 1)."""
        names = ["wavelength_nm", "responsivity_a_per_w", "responsivity_a_per_w_std"]
        table = read_table(path, names)
        wavelength_nm, value, std = (table.numbers(name) for name in names)
        check_positive(table, names[1], value)
        check_positive(table, names[2], std, zero=True)
        order = sorted_by_wavelength(table, wavelength_nm)
        return cls(wavelength_nm[order], value[order], std[order])


def read_scan(path: Path) -> ScanTable:
    """Read scan.csv; means come from its cells, or from the frames that it names."""
    table = read_table(path, _SCAN, (*_SIGNAL, *_FRAMES))
    by_frames = "frame" in table.names
    for name in _FRAMES if by_frames else _SIGNAL:
        if name not in table.names:
            wanted = ", ".join(_FRAMES if by_frames else _SIGNAL)
            msg = f"{path} has no column {name}: signals need {wanted}."
            raise InputError(msg, code="missing-column")
    numbers = {name: table.numbers(name) for name in _SCAN}
    for name in ("wavelength_nm", "exposure_us"):
        check_positive(table, name, numbers[name])
    signal, signal_std, dark, dark_std = _from_frames(table) if by_frames else _from_cells(table)
    return ScanTable(
        **numbers, signal_dn=signal - dark, signal_dn_std=np.hypot(signal_std, dark_std)
    )


def read_reference(path: Path) -> ReferenceTable:
    """Read reference.csv."""
    table = read_table(
        path,
        ["when", "wavelength_nm", "time_s", "current_a", "current_a_std"],
        ["angle_deg", "dark_current_a"],
    )
    when = table.text("when")
    for row, word in enumerate(when, start=1):
        if word not in {"before", "after"}:
            msg = f"{path}, row {row}: when is {word!r}; give before or after."
            raise InputError(msg, code="bad-when")
    current = table.numbers("current_a") - table.numbers("dark_current_a", empty=0.0)
    check_positive(table, "current_a without its dark current", current)
    std = table.numbers("current_a_std")
    check_positive(table, "current_a_std", std, zero=True)
    angle = [np.nan if not cell else 0.0 for cell in table.text("angle_deg")]
    return ReferenceTable(
        table.numbers("wavelength_nm"),
        table.numbers("angle_deg", empty=0.0) + np.array(angle),
        table.numbers("time_s"),
        current,
        std,
        np.array([word == "after" for word in when], np.float64),
    )


def _from_cells(table: Table) -> tuple[Columns, ...]:
    """Return signal, its std, dark and its std from the table's cells."""
    for name in ("signal_dn_std", "dark_dn_std"):
        check_positive(table, name, table.numbers(name), zero=True)
    return tuple(table.numbers(name) for name in _SIGNAL)


def _from_frames(table: Table) -> tuple[Columns, ...]:
    """Return the same from the frames that the table names."""
    folder = table.path.parent / "frames"
    first, last = (table.numbers(name).astype(int) for name in _FRAMES[2:])
    lit = list(zip(first.tolist(), last.tolist(), strict=True))
    found = [
        (*mean_signal(folder / frame, columns), *mean_signal(folder / dark, columns))
        for frame, dark, columns in zip(
            table.text("frame"), table.text("dark_frame"), lit, strict=True
        )
    ]
    return tuple(np.array(found, np.float64).T)
