"""Parts that shapes are made of, each with its transfer function in closed form."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from calib.mtf.simulation.response import Frequencies, Transfer


class Part(Protocol):
    """A piece of a PSF; its centre is its centroid."""

    @property
    def integral(self) -> float:
        """∫ over the plane, µm² times the amplitude."""
        ...

    @property
    def centre_um(self) -> tuple[float, float]:
        """Its centre, µm."""
        ...

    def spectrum(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return ∫ part·exp(−2πi f·u) du."""
        ...

    def density(self, x_um: Frequencies, y_um: Frequencies, blur_um: float) -> NDArray[np.floating]:
        """Return the part convolved with a Gaussian of standard deviation `blur_um` > 0."""
        ...


@dataclass(frozen=True)
class Rectangle:
    """A rectangle of constant amplitude (negative ones cut holes)."""

    width_um: float
    height_um: float
    centre_um: tuple[float, float] = (0.0, 0.0)
    amplitude: float = 1.0

    @property
    def integral(self) -> float:
        """Area times amplitude."""
        return self.amplitude * self.width_um * self.height_um

    def spectrum(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return the product of two sinc."""
        x, y = self.centre_um
        shape = np.sinc(self.width_um * fx_per_um) * np.sinc(self.height_um * fy_per_um)
        return np.asarray(
            self.integral * shape * np.exp(-2j * np.pi * (fx_per_um * x + fy_per_um * y))
        )

    def density(self, x_um: Frequencies, y_um: Frequencies, blur_um: float) -> NDArray[np.floating]:
        """Return the product of two smoothed boxes."""
        x, y = self.centre_um
        return (
            self.amplitude
            * _smoothed_box(x_um - x, self.width_um, blur_um)
            * _smoothed_box(y_um - y, self.height_um, blur_um)
        )


@dataclass(frozen=True)
class Spot:
    """A Gaussian spot of standard deviation `sigma_um`."""

    sigma_um: float
    centre_um: tuple[float, float] = (0.0, 0.0)
    integral: float = 1.0

    def spectrum(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return a Gaussian."""
        x, y = self.centre_um
        blur = diffusion(self.sigma_um, fx_per_um, fy_per_um)
        return np.asarray(
            self.integral * blur * np.exp(-2j * np.pi * (fx_per_um * x + fy_per_um * y))
        )

    def density(self, x_um: Frequencies, y_um: Frequencies, blur_um: float) -> NDArray[np.floating]:
        """Return a wider Gaussian."""
        variance = self.sigma_um**2 + blur_um**2
        away = (x_um - self.centre_um[0]) ** 2 + (y_um - self.centre_um[1]) ** 2
        spot: NDArray[np.floating] = np.exp(-0.5 * away / variance) / (2 * np.pi * variance)
        return self.integral * spot


def diffusion(
    sigma_um: float, fx_per_um: Frequencies, fy_per_um: Frequencies
) -> NDArray[np.floating]:
    """Return exp(−2π²σ²f²): what a Gaussian blur multiplies every frequency by."""
    factor: NDArray[np.floating] = np.exp(
        -2 * (np.pi * sigma_um) ** 2 * (fx_per_um**2 + fy_per_um**2)
    )
    return factor


def _smoothed_box(at: Frequencies, width: float, blur: float) -> NDArray[np.floating]:
    scale = np.sqrt(2) * blur
    box: NDArray[np.floating] = 0.5 * (
        erf((at + width / 2) / scale) - erf((at - width / 2) / scale)
    )
    return box
