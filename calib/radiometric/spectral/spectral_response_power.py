"""The power of the monochromator's beam at the time of each of the camera's signals."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.arrays import Columns
from calib.errors import InputError
from calib.radiometric.spectral.spectral_response_files import Photodiode, ReferenceTable, ScanTable


@dataclass(frozen=True)
class BeamPower:
    """One number per row of the scan, (n_rows,).

    Attributes:
        power_w: W, straight in time between the readings before and after.
        relative_std: Of `power_w`, from the readings' noise and the source's drift.
        drift: The reading after over that before, less 1.
        photodiode_relative_std: Of the photodiode's responsivity.
    """

    power_w: Columns
    relative_std: Columns
    drift: Columns
    photodiode_relative_std: Columns


def beam_power(
    scan: ScanTable, reference: ReferenceTable, photodiode: Photodiode, folder: Path
) -> BeamPower:
    """Return the beam's power for each row of `scan`.

    The path that the source took between the two readings is not known, only its ends: the current
    is taken as straight in time, and anything between the two readings as equally likely, which
    makes |after - before|/√12 of uncertainty (JCGM 100:2008, 4.3.7). The drift is the root mean
    square over an angle's wavelengths, less what the readings' own noise brings into it.

    Raises:
        InputError: `reference-missing`, `reference-order` or `photodiode-range`.
    """
    current = np.empty(len(scan.time_s))
    std = np.empty_like(current)
    drift = np.empty_like(current)
    for angle in np.unique(scan.angle_deg):
        rows = scan.angle_deg == angle
        wavelength_nm, time_s = scan.wavelength_nm[rows], scan.time_s[rows]
        before, after = (
            _reading(reference, angle, wavelength_nm, folder, after=which)
            for which in (False, True)
        )
        if (before.time_s > time_s).any() or (after.time_s < time_s).any():
            msg = (
                f"{folder}: at {angle:g}° a signal was not taken between the photodiode's "
                "readings before and after; mend the times."
            )
            raise InputError(msg, code="reference-order")
        share = (time_s - before.time_s) / np.maximum(after.time_s - before.time_s, 1e-12)
        change = after.current_a - before.current_a
        current[rows] = before.current_a + share * change
        noise = np.hypot((1 - share) * before.current_a_std, share * after.current_a_std)
        drift[rows] = change / before.current_a
        reading_noise = np.hypot(before.current_a_std, after.current_a_std) / before.current_a
        mean_square = float(np.mean(drift[rows] ** 2 - reading_noise**2))
        std[rows] = np.hypot(noise, before.current_a * (max(mean_square, 0.0) / 12) ** 0.5)
    responsivity, responsivity_std = _responsivity(photodiode, scan.wavelength_nm, folder)
    return BeamPower(current / responsivity, std / current, drift, responsivity_std / responsivity)


@dataclass(frozen=True)
class _Reading:
    """The photodiode's reading at the scan's wavelengths, each (n,)."""

    time_s: Columns
    current_a: Columns
    current_a_std: Columns


def _reading(
    reference: ReferenceTable, angle: float, wavelength_nm: Columns, folder: Path, *, after: bool
) -> _Reading:
    """Return the readings before or after an angle's scan, straight between their wavelengths."""
    chosen = reference.after == after
    own = chosen & np.isclose(reference.angle_deg, angle, atol=1e-6)
    chosen = own if own.any() else chosen & np.isnan(reference.angle_deg)
    when = "after" if after else "before"
    if not chosen.any():
        msg = (
            f"{folder}/reference.csv has no readings {when} the scan at {angle:g}°: "
            "without both, the source's drift is not known."
        )
        raise InputError(msg, code="reference-missing")
    order = np.flatnonzero(chosen)[np.argsort(reference.wavelength_nm[chosen])]
    grid = reference.wavelength_nm[order]
    if (
        (np.diff(grid) <= 0).any()
        or wavelength_nm.min() < grid[0]
        or wavelength_nm.max() > grid[-1]
    ):
        msg = (
            f"{folder}/reference.csv, {when} the scan at {angle:g}°: its wavelengths run from "
            f"{grid[0]:g} to {grid[-1]:g} nm; give each once, and all that the scan has."
        )
        raise InputError(msg, code="reference-missing")
    return _Reading(
        np.interp(wavelength_nm, grid, reference.time_s[order]),
        np.interp(wavelength_nm, grid, reference.current_a[order]),
        np.interp(wavelength_nm, grid, reference.current_a_std[order]),
    )


def _responsivity(
    photodiode: Photodiode, wavelength_nm: Columns, folder: Path
) -> tuple[Columns, Columns]:
    """Return the photodiode's responsivity and its std at the scan's wavelengths."""
    grid = photodiode.wavelength_nm
    if wavelength_nm.min() < grid[0] or wavelength_nm.max() > grid[-1]:
        msg = (
            f"{folder}/photodiode.csv covers {grid[0]:g} to {grid[-1]:g} nm, the scan "
            f"{wavelength_nm.min():g} to {wavelength_nm.max():g} nm: it is never extrapolated."
        )
        raise InputError(msg, code="photodiode-range")
    return (
        np.interp(wavelength_nm, grid, photodiode.responsivity_a_per_w),
        np.interp(wavelength_nm, grid, photodiode.responsivity_a_per_w_std),
    )
