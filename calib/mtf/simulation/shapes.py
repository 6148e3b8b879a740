"""Pixel shapes: sums of parts under one diffusion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.mtf.simulation.parts import Part, Rectangle, Spot, diffusion
from calib.mtf.simulation.response import Frequencies, Transfer

_SHARP_UM = 1e-3  # a diffusion too small to see, so that edges have a width


@dataclass(frozen=True)
class Shape:
    """A sum of parts, blurred by carriers that diffuse before they are collected.

    Attributes:
        parts: What it is made of.
        diffusion_um: Standard deviation of a Gaussian, µm.
    """

    parts: tuple[Part, ...]
    diffusion_um: float = 0.0

    @property
    def integral(self) -> float:
        """∫ PSF."""
        return sum(part.integral for part in self.parts)

    @property
    def centroid_um(self) -> tuple[float, float]:
        """∫ u·PSF / ∫ PSF, µm."""
        x, y = (sum(p.integral * p.centre_um[k] for p in self.parts) for k in (0, 1))
        return x / self.integral, y / self.integral

    def transfer(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return the transfer function, 1 at 0."""
        total: Transfer = np.zeros(np.broadcast(fx_per_um, fy_per_um).shape, np.complex128)
        for part in self.parts:
            total = total + part.spectrum(fx_per_um, fy_per_um)
        return total / self.integral * diffusion(self.diffusion_um, fx_per_um, fy_per_um)

    def density(self, x_um: Frequencies, y_um: Frequencies) -> NDArray[np.floating]:
        """Return the PSF itself, ∫ = 1, per µm², with (x, y) counted from its centroid."""
        blur, (cx, cy) = max(self.diffusion_um, _SHARP_UM), self.centroid_um
        total = sum(part.density(x_um + cx, y_um + cy, blur) for part in self.parts)
        return np.asarray(total / self.integral, np.float64)


def square(side_um: float, diffusion_um: float = 0.0) -> Shape:
    """Return a square pixel."""
    return Shape((Rectangle(side_um, side_um),), diffusion_um)


def truncated_corner(
    side_um: float, corner_um: float, amplitude: float, diffusion_um: float = 0.0
) -> Shape:
    """Return a square whose corner at negative x and y has another amplitude (Fig. 5)."""
    centre = -(side_um - corner_um) / 2
    cut = Rectangle(corner_um, corner_um, (centre, centre), amplitude - 1)
    return Shape((Rectangle(side_um, side_um), cut), diffusion_um)


def l_shape(side_um: float, arm_um: float, diffusion_um: float = 0.0) -> Shape:
    """Return two arms of a square's side, which share a corner."""
    rest = side_um - arm_um
    upright = Rectangle(arm_um, side_um, (-rest / 2, 0.0))
    foot = Rectangle(rest, arm_um, (arm_um / 2, -rest / 2))
    return Shape((upright, foot), diffusion_um)


def shamrock(side_um: float, leaf: float, leaf_um: float, diffusion_um: float = 0.0) -> Shape:
    """Return a square with four leaves over its sides, as carriers lost to neighbours make it.

    Args:
        side_um: The square's side, µm.
        leaf: Each leaf's share of the square's integral.
        leaf_um: A leaf's standard deviation, µm.
        diffusion_um: Of all, µm.
    """
    away = side_um / 2
    leaves = tuple(
        Spot(leaf_um, (away * i, away * j), leaf * side_um**2)
        for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )
    return Shape((Rectangle(side_um, side_um), *leaves), diffusion_um)
