"""Signal that ends up in a neighbour: by diffusion beside the pixel, or electrically."""

from dataclasses import dataclass

import numpy as np

from calib.mtf.simulation.response import Frequencies, PixelResponse, Transfer


@dataclass(frozen=True)
class NeighbourCrosstalk:
    """Each pixel's signal holds a share of its neighbours'.

    Attributes:
        pixel: The response without crosstalk.
        pitch_um: The neighbours' distance, µm.
        side: Share of each of the four neighbours beside.
        corner: Share of each of the four at the corners.
    """

    pixel: PixelResponse
    pitch_um: float
    side: float
    corner: float = 0.0

    @property
    def centroid_um(self) -> tuple[float, float]:
        """The pixel's own: the neighbours lie evenly about it."""
        return self.pixel.centroid_um

    def transfer(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return the transfer function, 1 at 0."""
        x, y = (np.cos(2 * np.pi * self.pitch_um * f) for f in (fx_per_um, fy_per_um))
        own = 1 - 4 * (self.side + self.corner)
        weight = own + 2 * self.side * (x + y) + 4 * self.corner * x * y
        return np.asarray(self.pixel.transfer(fx_per_um, fy_per_um) * weight)
