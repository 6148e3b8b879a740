"""Vignette: the image gets darker away from the optical axis.

Source: the cos^4 law of an ideal lens; Olsen et al., Radiometric calibration for AgCam (2010),
section 5.2, for a measured polynomial where mounts and filters shade more than that.
"""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns, Lines
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Vignette(Effect):
    """Scale each column by VE = cos^4(angle to the axis) x (1 + c2 x^2 + c3 x^3 + ...).

    x is the distance from the axis as a share of the distance to the farther end of the line, so
    that |x| <= 1, negative towards column 0. The polynomial starts at x^2: VE is 1 and level at
    the axis.

    Attributes:
        axis_column: Where the optical axis meets the line, from 0; the centre where not given.
        focal_length_columns: Focal length in units of the column pitch; inf for no cos^4.
        coefficients: c2, c3, ... of the measured polynomial; empty for none.
    """

    name: ClassVar[str] = "vignette"
    stage: ClassVar[Stage] = Stage.PHOTONS
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True

    axis_column: float | None = parameter(None, unit="column")
    focal_length_columns: float = parameter(inf, unit="column", low=1.0, neutral=inf)
    coefficients: tuple[float, ...] = parameter((), unit="1", low=-100.0, high=100.0, neutral=())

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance x us in and out, (n_lines, n_columns)."""
        return signal * self.profile(signal.shape[-1])

    def axis(self, n_columns: int) -> float:
        """Return the column of the optical axis, from 0."""
        return (n_columns - 1) / 2 if self.axis_column is None else self.axis_column

    def profile(self, n_columns: int) -> Columns:
        """Return VE, (n_columns,), 1 at the axis."""
        axis = self.axis(n_columns)
        distance = np.arange(n_columns, dtype=np.float64) - axis
        x = distance / max(abs(axis), abs(n_columns - 1 - axis), 1.0)
        measured = np.polynomial.polynomial.polyval(x, [1.0, 0.0, *self.coefficients])
        cos4 = (1.0 + (distance / self.focal_length_columns) ** 2) ** -2
        return np.asarray(cos4 * measured)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless VE is positive in every column."""
        lowest = float(self.profile(camera.columns).min())
        if not lowest > 0:
            raise InputError(
                f"effect vignette: the profile falls to {lowest:.3g} within the "
                f"{camera.columns} columns; give coefficients that keep it above 0.",
                code="vignette-not-positive",
            )
