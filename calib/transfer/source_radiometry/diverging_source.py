"""A source that sends its power into a cone, in the middle of which an aperture lets light through.

Source: Yielding, Cain and Seal, Statistical photocalibration of photodetectors for radiometry
without calibrated light sources, Opt. Eng. 57 (2018) 014107, Equation 21. Planck's constant and the
speed of light are exact in the SI since 2019, and the values of CODATA 2018.
"""

from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.constants import c, h

from calib.errors import InputError
from calib.transfer.source_radiometry.bounded import Bounded

Number = TypeVar("Number", float, NDArray[np.float64])

UNITS = {
    "power_w": "W",
    "wavelength_nm": "nm",
    "half_angle_deg": "deg",
    "peak_over_mean": "1",
    "distance_m": "m",
    "aperture_radius_m": "m",
    "exposure_s": "s",
}
"""Of the inputs of Eq. 21."""
RISING = {
    "power_w": True,
    "wavelength_nm": True,
    "half_angle_deg": False,
    "peak_over_mean": True,
    "distance_m": False,
    "aperture_radius_m": True,
    "exposure_s": True,
}
"""Whether the photons rise with an input; they do so, or fall, over all of its range."""


def photons_through_aperture(
    *,
    power_w: Number,
    wavelength_nm: Number,
    half_angle_deg: Number,
    peak_over_mean: Number,
    distance_m: Number,
    aperture_radius_m: Number,
    exposure_s: Number,
) -> Number:
    """Return Eq. 21, E[K] = Ip r^2 Pt dt / (Iavg h nu [tan(theta) R]^2), the expected photons.

    The power Pt fills a disc of radius R tan(theta) at the distance R of the aperture, on average
    with the irradiance Iavg; the aperture of radius r, small against the disc, stands at its peak,
    Ip. Each photon carries h nu = h c / wavelength.
    """
    photons_per_s = power_w * wavelength_nm * 1e-9 / (h * c)
    disc_radius_m = np.tan(np.deg2rad(half_angle_deg)) * distance_m
    share = peak_over_mean * (aperture_radius_m / disc_radius_m) ** 2
    return share * photons_per_s * exposure_s  # type: ignore[no-any-return]


@dataclass(frozen=True)
class DivergingSource:
    """What Eq. 21 has to know of an experiment, each with its bounds.

    Attributes:
        power_w: Optical power of the source, W.
        wavelength_nm: Of its light, nm.
        half_angle_deg: Half of the angle into which it shines, degrees, below 90.
        peak_over_mean: Peak irradiance over the mean one within that angle, 1.
        distance_m: From the source to the aperture, m.
        aperture_radius_m: Of the aperture, m.
        exposure_s: During which photons are counted, s.
    """

    power_w: Bounded
    wavelength_nm: Bounded
    half_angle_deg: Bounded
    peak_over_mean: Bounded
    distance_m: Bounded
    aperture_radius_m: Bounded
    exposure_s: Bounded

    def __post_init__(self) -> None:
        """Raise InputError where a unit is another, or the cone is none."""
        for name, given in self.inputs().items():
            if given.unit != UNITS[name]:
                raise InputError(
                    f"{name} is given in {given.unit}; give it in {UNITS[name]}.", code="wrong-unit"
                )
        if self.half_angle_deg.high >= 90:
            raise InputError(
                f"half_angle_deg goes up to {self.half_angle_deg.high:g}; give less than 90, for "
                "a cone.",
                code="bad-bounds",
            )

    def inputs(self) -> dict[str, Bounded]:
        """Return the inputs by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def nominal(self) -> float:
        """Return the photons of the nominal values."""
        return float(photons_through_aperture(**{n: b.value for n, b in self.inputs().items()}))

    def corners(self) -> tuple[float, float]:
        """Return the fewest and the most photons that the bounds allow, all at their worst.

        Eq. 21 is monotonic in every input, so that both lie in corners of the inputs' box.
        """
        few = {n: b.low if RISING[n] else b.high for n, b in self.inputs().items()}
        many = {n: b.high if RISING[n] else b.low for n, b in self.inputs().items()}
        return float(photons_through_aperture(**few)), float(photons_through_aperture(**many))
