"""From a monochromator scan to the camera's spectral response at each incidence angle.

Source: Olsen et al. 2010 (AgCam), section 3 (1): every 3 nm, at -4 to 4°, between two readings of
a calibrated silicon photodiode.

At wavelength λ the camera's response is its signal per exposure time and per power of the beam:
    r = (DN - dark) / (t · P),   P = I(λ, time) / s(λ)
with the photodiode's responsivity s (A/W) and its current I between the two readings.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import InputError
from calib.radiometric.spectral.spectral_response import SpectralResponse
from calib.radiometric.spectral.spectral_response_files import (
    Photodiode,
    ScanTable,
    read_reference,
    read_scan,
)
from calib.radiometric.spectral.spectral_response_power import beam_power

ByAngle = NDArray[np.float64]
"""A number by angle and wavelength, (n_angles, n_wavelengths)."""


@dataclass(frozen=True)
class SpectralScan:
    """The reduced scan; responses in DN/µs per W of the beam.

    Attributes:
        wavelength_nm: Increasing, (n_wavelengths,).
        angle_deg: Increasing, (n_angles,).
        response: By angle and wavelength.
        std: What does not repeat from one angle to another: noise, readings, the source's drift.
        drift: The photodiode's reading after over that before, less 1.
        photodiode_relative_std: Of the photodiode's responsivity; shared by all angles,
            (n_wavelengths,).
    """

    wavelength_nm: Columns
    angle_deg: Columns
    response: ByAngle
    std: ByAngle
    drift: ByAngle
    photodiode_relative_std: Columns

    @classmethod
    def load(cls, folder: Path | str) -> "SpectralScan":
        """Read and reduce the scan in `folder`.

        Raises:
            InputError: A file or a row is missing or cannot be used; the sentence says which.
        """
        folder = Path(folder)
        scan = read_scan(folder / "scan.csv")
        reference = read_reference(folder / "reference.csv")
        photodiode = Photodiode.load(folder / "photodiode.csv")
        wavelength_nm, angle_deg, rows = _grid(scan, folder / "scan.csv")
        power = beam_power(scan, reference, photodiode, folder)
        response = scan.signal_dn / (scan.exposure_us * power.power_w)
        noise = scan.signal_dn_std / (scan.exposure_us * power.power_w)
        std = np.hypot(noise, response * power.relative_std)
        return cls(
            wavelength_nm,
            angle_deg,
            response[rows],
            std[rows],
            power.drift[rows],
            power.photodiode_relative_std[rows[0]],
        )

    def at_angle(self, angle_deg: float = 0.0) -> SpectralResponse:
        """Return the relative response at one of the scan's angles, all uncertainties included.

        Raises:
            InputError: `no-such-angle`.
        """
        index = self.index_of(angle_deg)
        shared = self.response[index] * self.photodiode_relative_std
        return SpectralResponse.normalised(
            self.wavelength_nm, self.response[index], np.hypot(self.std[index], shared)
        )

    def index_of(self, angle_deg: float) -> int:
        """Return the row of an angle; InputError `no-such-angle` where it was not scanned."""
        found = np.flatnonzero(np.isclose(self.angle_deg, angle_deg, atol=1e-6))
        if len(found) == 0:
            angles = ", ".join(f"{angle:g}" for angle in self.angle_deg)
            msg = f"The scan has no angle of {angle_deg:g}°: choose one of {angles}."
            raise InputError(msg, code="no-such-angle")
        return int(found[0])

    @property
    def largest_drift(self) -> float:
        """The source's largest relative change between a reading before and after."""
        return float(np.abs(self.drift).max())


def _grid(scan: ScanTable, path: Path) -> tuple[Columns, Columns, NDArray[np.intp]]:
    """Return wavelengths, angles and the row of each pair, (n_angles, n_wavelengths)."""
    wavelengths, column = np.unique(scan.wavelength_nm, return_inverse=True)
    angles, line = np.unique(scan.angle_deg, return_inverse=True)
    counts = np.zeros((len(angles), len(wavelengths)), np.intp)
    np.add.at(counts, (line, column), 1)
    wrong = np.argwhere(counts != 1)
    if len(wrong):
        at, wavelength = angles[wrong[0][0]], wavelengths[wrong[0][1]]
        msg = (
            f"{path} has {counts[tuple(wrong[0])]} rows for {wavelength:g} nm at {at:g}°: "
            "each angle needs each wavelength once."
        )
        raise InputError(msg, code="scan-incomplete")
    rows = np.zeros(counts.shape, np.intp)
    rows[line, column] = np.arange(len(line))
    return wavelengths, angles, rows
