"""Vignette: the image gets darker away from the optical axis.

Source: the cos^4 law of an ideal lens; Olsen et al., Radiometric calibration for AgCam (2010),
section 5.2, for a measured polynomial where mounts and filters shade more than that.
"""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.recording.frame_codes import sample_shape
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Vignette(Effect):
    """Scale each pixel by VE = cos^4(angle to the axis) x (1 + c2 x^2 + c3 x^3 + ...).

    x is the distance from the axis as a share of the distance to the farther end of the line, so
    that |x| <= 1, negative towards column 0. Of a frame, whose pixels are taken to be square, it is
    the share of the distance to the farthest corner, and never negative. The polynomial starts at
    x^2: VE is 1 and level at the axis.

    Attributes:
        axis_column: Where the optical axis meets the line, from 0; the centre where not given.
        axis_row: Likewise, of a frame; a line has none.
        focal_length_columns: Focal length in units of the column pitch; inf for no cos^4.
        coefficients: c2, c3, ... of the measured polynomial; empty for none.
    """

    name: ClassVar[str] = "vignette"
    stage: ClassVar[Stage] = Stage.PHOTONS
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True

    axis_column: float | None = parameter(None, unit="column")
    axis_row: float | None = parameter(None, unit="row")
    focal_length_columns: float = parameter(inf, unit="column", low=1.0, neutral=inf)
    coefficients: tuple[float, ...] = parameter((), unit="1", low=-100.0, high=100.0, neutral=())

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance x us in and out, (n_lines, *sample)."""
        return signal * self.profile(signal.shape[1:])

    def axis(self, sample: SampleShape) -> tuple[float, ...]:
        """Return where the optical axis meets a sample: (column,), or (row, column), from 0."""
        shape = (sample,) if isinstance(sample, int) else sample
        given = (self.axis_row, self.axis_column)[-len(shape) :]
        return tuple((n - 1) / 2 if a is None else a for a, n in zip(given, shape, strict=True))

    def profile(self, sample: SampleShape) -> Pixels:
        """Return VE, (*sample,), 1 at the axis."""
        shape = (sample,) if isinstance(sample, int) else sample
        axis = self.axis(shape)
        along = [np.arange(n, dtype=np.float64) - a for n, a in zip(shape, axis, strict=True)]
        ends = [max(abs(a), abs(n - 1 - a)) for n, a in zip(shape, axis, strict=True)]
        distance = along[0] if len(shape) == 1 else np.hypot(along[0][:, np.newaxis], along[1])
        x = distance / max(float(np.hypot.reduce(ends)), 1.0)
        measured = np.polynomial.polynomial.polyval(x, [1.0, 0.0, *self.coefficients])
        cos4 = (1.0 + (distance / self.focal_length_columns) ** 2) ** -2
        return np.asarray(cos4 * measured)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless VE is positive in every pixel, and a line has no row."""
        if camera.rows is None and self.axis_row is not None:
            raise InputError(
                f"effect vignette: axis_row is {self.axis_row}, but a line sensor has no rows; "
                "leave it out.",
                code="area-sensor",
            )
        lowest = float(self.profile(sample_shape(camera)).min())
        if not lowest > 0:
            raise InputError(
                f"effect vignette: the profile falls to {lowest:.3g} within the "
                "picture; give coefficients that keep it above 0.",
                code="vignette-not-positive",
            )
