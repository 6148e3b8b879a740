"""The data sheet's numbers in words: rounded to their uncertainty, reasons where there are none."""

import math
from dataclasses import dataclass

from calib.report.camera_words import camera_line
from calib.transfer.emva1288.catalogue import CATALOGUE, Figure
from calib.transfer.emva1288.sheet import DataSheet
from calib.transfer.estimate import Estimate

HEADINGS = {
    "sensitivity": "Sensitivity, noise and saturation",
    "linearity": "Linearity",
    "dark_current": "Dark current",
    "spatial": "Nonuniformity",
}
Rows = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Line:
    """A figure as the table shows it."""

    title: str
    symbol: str
    value: str
    reason: str
    source: str


@dataclass(frozen=True)
class Section:
    """The lines under one heading."""

    heading: str
    lines: tuple[Line, ...]


def sections(sheet: DataSheet) -> tuple[Section, ...]:
    """Return the table, heading by heading."""
    return tuple(
        Section(heading, tuple(_line(c, sheet[c.name]) for c in CATALOGUE if c.section == section))
        for section, heading in HEADINGS.items()
    )


def _line(figure: Figure, known: Estimate) -> Line:
    value = "" if not known.is_known else f"{rounded(known)} {_unit(figure.unit)}".rstrip()
    return Line(figure.title, figure.symbol, value, known.reason, figure.source)


def rounded(known: Estimate) -> str:
    """Return value ± standard uncertainty, the uncertainty to two digits.

    >>> rounded(Estimate(0.24917, 0.00321, "DN/e-"))
    '0.2492 ± 0.0032'
    >>> rounded(Estimate(25883.8, 20.2, "photon"))
    '25884 ± 20'
    """
    if not known.std > 0:
        return f"{known.value:.5g}"
    digits = max(0, 1 - math.floor(math.log10(known.std)))
    return f"{known.value:.{digits}f} ± {known.std:.{digits}f}"


def _unit(unit: str) -> str:
    return unit.replace("e-", "e⁻") if unit != "1" else ""


def conditions(sheet: DataSheet) -> Rows:
    """Return what the camera looked at, and how."""
    source, camera = sheet.header.source, sheet.header.camera
    size = f"{camera.rows} rows, " if camera.rows else "a line sensor, "
    exposures = sheet.darks.exposure_us
    return (
        ("Recording", sheet.recording),
        ("Camera", size + camera_line(camera)),
        ("Light", f"{source.kind}, {_stated(source.wavelength_nm, 'nm')}"),
        ("Photons", _stated(source.photons_per_pixel_per_us, "per pixel and µs at level 1")),
        ("Flats", f"{len(sheet.transfer.light)} blocks, {_range(sheet)}"),
        ("Darks", f"{len(exposures)} blocks, {exposures.min():g} … {exposures.max():g} µs"),
    )


def _stated(value: float | None, unit: str) -> str:
    return "not stated" if value is None else f"{value:g} {unit}"


def _range(sheet: DataSheet) -> str:
    light = sheet.transfer.light
    return f"exposure × level {light.min():g} … {light.max():g} µs"


def photon_scale(sheet: DataSheet) -> str:
    """Return what the uncertainties leave out."""
    scaled = ", ".join(c.symbol for c in CATALOGUE if c.scaled_by_photons)
    relative = sheet.photon_scale_relative_std
    known = "is not stated" if relative is None else f"is {100 * relative:.2g} % (type B, k = 1)"
    return (
        "Uncertainties are standard uncertainties (k = 1), type A. That of the photon scale, which "
        f"{scaled} share, {known}; it is not in their figures."
    )
