"""PSFs that vanish beyond 3 × 3 pixels: square cells, each with its exact transfer function."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.mtf.harmonic_sums import Complex

Axis = NDArray[np.floating]
Matrix = NDArray[np.floating]


@dataclass(frozen=True)
class CompactBasis:
    """A square of n × n cells about the origin; a PSF is the share of the signal in each.

    Attributes:
        side_um: The square's side, µm.
        cells: n, along a side.
    """

    side_um: float
    cells: int

    @property
    def cell_um(self) -> float:
        """Side of a cell, µm."""
        return self.side_um / self.cells

    @cached_property
    def position_um(self) -> Axis:
        """Centres of the cells along an axis, (n,), µm."""
        return self.cell_um * (np.arange(self.cells) - (self.cells - 1) / 2)

    def along(self, frequency_per_um: Axis) -> Complex:
        """Return what a frequency along an axis makes of the cells: (n_frequencies, n)."""
        turned = np.exp(-2j * np.pi * np.multiply.outer(frequency_per_um, self.position_um))
        return np.asarray(turned * np.sinc(frequency_per_um * self.cell_um)[:, None])

    def at(self, frequency_per_um: NDArray[np.floating]) -> Complex:
        """Return the same for frequencies (n_frequencies, 2): (n_frequencies, n²), rows first."""
        fx, fy = (self.along(frequency_per_um[:, k]) for k in (0, 1))
        return np.asarray((fy[:, :, None] * fx[:, None, :]).reshape(len(fx), -1))

    @cached_property
    def places_um(self) -> Matrix:
        """Each cell's x and y, (2, n²), µm."""
        y, x = np.meshgrid(self.position_um, self.position_um, indexing="ij")
        return np.stack([x.ravel(), y.ravel()])

    def distances_um(self) -> Matrix:
        """Return the distance of any two cells, (n², n²), µm."""
        x, y = self.places_um
        return np.asarray(np.hypot(np.subtract.outer(x, x), np.subtract.outer(y, y)))
