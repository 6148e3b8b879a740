"""A transfer function as every method gives it: values and uncertainties at any frequencies."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from calib.mtf.harmonic_sums import Complex

Axis = NDArray[np.floating]
Map = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class TransferMap:
    """Values on a grid of frequencies in the detector's frame; arrays are [fy, fx].

    Attributes:
        transfer: 1 at 0; the PSF's centroid is at 0.
        real_std: Standard uncertainty of its real part.
        imaginary_std: Standard uncertainty of its imaginary part.
        valid: Where the recording determines it.
    """

    transfer: Complex
    real_std: Map
    imaginary_std: Map
    valid: NDArray[np.bool_]

    @property
    def std(self) -> Map:
        """√E|δT|²: of the complex number, as the standard deviation of many recordings has it."""
        return np.asarray(np.hypot(self.real_std, self.imaginary_std))

    @property
    def modulus_std(self) -> Map:
        """Of |T|, real and imaginary part taken as independent."""
        size = np.maximum(np.abs(self.transfer), 1e-12)
        along = np.hypot(
            self.transfer.real * self.real_std, self.transfer.imag * self.imaginary_std
        )
        return np.asarray(along / size)


class TransferFunction(Protocol):
    """What a method found."""

    def at(self, fx_per_um: Axis, fy_per_um: Axis) -> TransferMap:
        """Return it on a grid: columns at `fx_per_um`, rows at `fy_per_um`, cycles per µm."""
        ...

    def psf(self, position_um: Axis) -> tuple[Map, Map]:
        """Return the PSF, ∫ = 1, per µm², and its std at (y, x), µm from its centroid."""
        ...


def band_limited_psf(transfer: Complex, frequency_per_um: Axis, position_um: Axis) -> Map:
    """Return what an inverse Fourier transform makes of a transfer function that ends somewhere.

    Args:
        transfer: [fy, fx] on one axis of equal steps; 0 where it is not known.
        frequency_per_um: The axis, both signs.
        position_um: Where the PSF is wanted, both axes.
    """
    turned = np.exp(2j * np.pi * np.multiply.outer(position_um, frequency_per_um))
    step = frequency_per_um[1] - frequency_per_um[0]
    psf: Map = (turned @ transfer @ turned.T).real * step**2
    return psf
