"""A source of several wavelengths in front of the grating.

Orders on one circle propagate with one phase, so that their pattern depends on neither distance nor
wavelength. An unwanted order off the circle does not: behind the grating it runs ahead of them by
π·λ·z·(p² + q² − η²)/a0² (Fresnel), and a polychromatic source averages its fringes away.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError


@dataclass(frozen=True)
class Source:
    """A collimated source.

    Attributes:
        wavelength_um: Its wavelengths, µm.
        weight: Their share in the signal, in any unit.
        distance_um: From grating to detector, z, µm.
    """

    wavelength_um: tuple[float, ...]
    weight: tuple[float, ...]
    distance_um: float

    def __post_init__(self) -> None:
        if len(self.wavelength_um) != len(self.weight) or not sum(self.weight) > 0:
            msg = "A source needs a weight for each wavelength, and their sum above 0: give both"
            raise InputError(msg, code="bad-source")

    def coherence(self, squared: NDArray[np.int64], period_um: float) -> NDArray[np.complex128]:
        """Return how two orders' fringe survives, by the difference of their p² + q²; |γ| ≤ 1."""
        weight = np.array(self.weight) / sum(self.weight)
        turns = np.multiply.outer(squared / period_um**2, np.array(self.wavelength_um))
        fringes: NDArray[np.complex128] = np.exp(-1j * np.pi * self.distance_um * turns) @ weight
        return fringes
