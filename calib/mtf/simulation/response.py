"""What a pixel response is, and its centred transfer function."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Frequencies = NDArray[np.floating]
Transfer = NDArray[np.complex128]


class PixelResponse(Protocol):
    """A PSF in the detector's frame: x along columns, y along rows, the image is O ∗ PSF.

    (The pixel's sensitivity at u from its centre is PSF(−u).)
    """

    def transfer(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return ∫ PSF·exp(−2πi f·u) du / ∫ PSF at frequencies in cycles per µm, exactly."""
        ...

    @property
    def centroid_um(self) -> tuple[float, float]:
        """∫ u·PSF du / ∫ PSF, (x, y), µm."""
        ...


def centred(response: PixelResponse, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
    """Return the transfer function with the PSF's centroid at 0, as estimates have it."""
    x, y = response.centroid_um
    turned = np.exp(2j * np.pi * (fx_per_um * x + fy_per_um * y))
    return np.asarray(response.transfer(fx_per_um, fy_per_um) * turned)
