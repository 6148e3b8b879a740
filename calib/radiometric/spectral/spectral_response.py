"""The relative spectral response of a camera's band, and the figures that describe it.

Relative means: response to radiant power (not photons), divided by its largest value. How it is
measured is in `spectral_response_scan` and `docs/spectral-response.md`.
"""

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from calib.arrays import Columns
from calib.errors import InputError, NotDeterminedError
from calib.radiometric.spectral.spectral_table import (
    check_positive,
    read_table,
    sorted_by_wavelength,
)
from calib.recording.durable import write_whole

OUT_OF_BAND_LEVEL = 0.01
"""The band ends where the response first falls below this share of its peak."""


@dataclass(frozen=True)
class Figure:
    """A number and its standard uncertainty (k = 1), in the same unit."""

    value: float
    std: float


@dataclass(frozen=True)
class SpectralResponse:
    """Relative response R(λ), straight between its points and 0 outside them.

    Attributes:
        wavelength_nm: Increasing, (n,).
        response: Peak 1, (n,); may be slightly negative where nothing but noise is.
        std: Standard uncertainty, (n,). Independent from point to point unless its user says
            otherwise; the scale, which R does not have, is not in it.
    """

    wavelength_nm: Columns
    response: Columns
    std: Columns

    def __post_init__(self) -> None:
        n = len(self.wavelength_nm)
        if n < 2 or self.response.shape != (n,) or self.std.shape != (n,):
            msg = "A spectral response needs two points or more, each with response and std."
            raise InputError(msg, code="bad-response")
        if not np.isclose(self.response.max(), 1.0, atol=1e-9):
            msg = f"A relative response peaks at 1, not at {self.response.max():g}: divide by it."
            raise InputError(msg, code="bad-response")

    @classmethod
    def normalised(cls, wavelength_nm: Columns, response: Columns, std: Columns) -> Self:
        """Return the response divided by its peak, which is a choice of scale and has no error."""
        peak = float(np.max(response))
        if not peak > 0:
            msg = "No response to light is seen at any wavelength: check shutter and dark."
            raise NotDeterminedError(msg, code="no-response")
        return cls(wavelength_nm, response / peak, std / peak)

    @classmethod
    def load(cls, path: Path | str) -> Self:
        """Read a CSV file: wavelength_nm, response, response_std (0 where not there)."""
        table = read_table(Path(path), ["wavelength_nm", "response"], ["response_std"])
        wavelength_nm = table.numbers("wavelength_nm")
        order = sorted_by_wavelength(table, wavelength_nm)
        std = table.numbers("response_std", empty=0.0)
        check_positive(table, "response_std", std, zero=True)
        return cls.normalised(wavelength_nm[order], table.numbers("response")[order], std[order])

    def save(self, path: Path | str, *, comment: str = "") -> None:
        """Write the table that `load` reads, whole or not at all; `comment` is its first line."""
        text = io.StringIO()
        if comment:
            text.write(f"# {' '.join(comment.split())}\n")
        table = csv.writer(text, lineterminator="\n")
        table.writerow(["wavelength_nm", "response", "response_std"])
        columns = (self.wavelength_nm, self.response, self.std)
        table.writerows(zip(*(each.tolist() for each in columns), strict=True))
        write_whole(Path(path), text.getvalue().encode())

    @property
    def half_maximum_nm(self) -> tuple[float, float]:
        """The outermost wavelengths at which the response is half its peak."""
        return _outermost(self.wavelength_nm, self.response, 0.5)

    @property
    def centre_wavelength_nm(self) -> Figure:
        """Midway between the half-maximum wavelengths."""
        return self._propagated(lambda r: float(np.mean(_outermost(self.wavelength_nm, r, 0.5))))

    @property
    def fwhm_nm(self) -> Figure:
        """Full width at half maximum; a monochromator's own width is in it, not taken off."""
        return self._propagated(lambda r: float(np.diff(_outermost(self.wavelength_nm, r, 0.5))[0]))

    @property
    def centroid_nm(self) -> Figure:
        """∫λR dλ / ∫R dλ."""
        return self._propagated(lambda r: _centroid(self.wavelength_nm, r))

    @property
    def bandwidth_nm(self) -> Figure:
        """∫R dλ: what a flat spectrum per nm is multiplied by."""
        return self._propagated(lambda r: float(np.trapezoid(r, self.wavelength_nm)))

    @property
    def band_nm(self) -> tuple[float, float] | None:
        """Where the response first falls to 1 % on both sides of the peak; None if it never does.

        Where noise hides 1 %, the band ends where the noise first lets the response fall so low.
        """
        peak = int(np.argmax(self.response))
        right = _first_below(self.wavelength_nm[peak:], self.response[peak:])
        left = _first_below(-self.wavelength_nm[peak::-1], self.response[peak::-1])
        return None if left is None or right is None else (-left, right)

    @property
    def out_of_band_fraction(self) -> Figure | None:
        """Share of ∫R dλ outside `band_nm`, as the scan covers it; None where there is no band.

        Noise is left in with both signs, so that it averages out instead of adding up.
        """
        band = self.band_nm
        if band is None:
            return None
        grid = np.union1d(self.wavelength_nm, band)
        inside = (grid >= band[0]) & (grid <= band[1])

        def fraction(response: Columns) -> float:
            fine = np.interp(grid, self.wavelength_nm, response)
            return float(1 - np.trapezoid(fine[inside], grid[inside]) / np.trapezoid(fine, grid))

        return self._propagated(fraction)

    def _propagated(self, function: Callable[[Columns], float]) -> Figure:
        """Return a function of the response with its std, the points taken as independent."""
        steps = np.diag(np.maximum(1e-3 * self.std, 1e-9))
        contributions = [
            (function(self.response + step) - function(self.response - step)) / (2 * step.max()) * u
            for step, u in zip(steps, self.std, strict=True)
            if u > 0
        ]
        return Figure(function(self.response), float(np.linalg.norm(contributions)))


def _centroid(wavelength_nm: Columns, response: Columns) -> float:
    weighted = np.trapezoid(wavelength_nm * response, wavelength_nm)
    return float(weighted / np.trapezoid(response, wavelength_nm))


def _outermost(wavelength_nm: Columns, response: Columns, share: float) -> tuple[float, float]:
    """Return the first and last wavelength at which the response is `share` of its peak."""
    level = share * response.max()
    above = np.flatnonzero(response >= level)
    first, last = int(above[0]), int(above[-1])
    if first == 0 or last == len(response) - 1:
        msg = (
            f"The response is still above {share:.0%} of its peak at "
            f"{wavelength_nm[0 if first == 0 else -1]:g} nm, where the scan ends: scan further."
        )
        raise NotDeterminedError(msg, code="band-not-covered")
    rise, fall = slice(first - 1, first + 1), slice(last, last + 2)
    left = np.interp(level, response[rise], wavelength_nm[rise])
    right = np.interp(-level, -response[fall], wavelength_nm[fall])
    return float(left), float(right)


def _first_below(wavelength_nm: Columns, response: Columns) -> float | None:
    """Return where a response that starts at its peak first falls to 1 % of it."""
    level = OUT_OF_BAND_LEVEL * response[0]
    below = np.flatnonzero(response < level)
    if len(below) == 0:
        return None
    after = slice(below[0] - 1, below[0] + 1)
    return float(np.interp(-level, -response[after], wavelength_nm[after]))
