"""A pixel response given by its samples, as a device simulator writes it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.mtf.simulation.response import Frequencies, Transfer


@dataclass(frozen=True, eq=False)
class Sampled:
    """A PSF that is constant within cells: exact for that staircase, whatever the frequency.

    Attributes:
        values: (n_y, n_x), in any unit.
        step_um: Side of a cell, µm; the array's centre is the origin.
    """

    values: NDArray[np.floating]
    step_um: float

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or not np.isfinite(self.values).all() or not self.values.sum() > 0:
            msg = "A sampled response is an (n_y, n_x) array of finite numbers with a positive sum."
            raise InputError(msg, code="bad-response")

    @property
    def centroid_um(self) -> tuple[float, float]:
        """∫ u·PSF / ∫ PSF, µm."""
        y, x = self._axes()
        total = self.values.sum()
        return float(self.values.sum(0) @ x / total), float(self.values.sum(1) @ y / total)

    def transfer(self, fx_per_um: Frequencies, fy_per_um: Frequencies) -> Transfer:
        """Return the transfer function, 1 at 0."""
        fx, fy = np.broadcast_arrays(fx_per_um, fy_per_um)
        y, x = self._axes()
        along_x = np.exp(-2j * np.pi * np.multiply.outer(fx.ravel(), x))
        along_y = np.exp(-2j * np.pi * np.multiply.outer(fy.ravel(), y))
        total = np.einsum("fx,fx->f", along_y @ self.values, along_x) / self.values.sum()
        cell = np.sinc(self.step_um * fx) * np.sinc(self.step_um * fy)
        return np.asarray(total.reshape(fx.shape) * cell, np.complex128)

    def _axes(self) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        n_y, n_x = self.values.shape
        return (
            self.step_um * (np.arange(n_y) - (n_y - 1) / 2),
            self.step_um * (np.arange(n_x) - (n_x - 1) / 2),
        )
