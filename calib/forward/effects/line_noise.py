"""Line noise: each line, each row of a frame, or each frame as a whole, has an offset of its own.

Source: EMVA Standard 1288, Release 4.0 Linear, the row part of the temporal noise: reference or
supply noise that all columns of a line share. Where the reference is sampled once for a frame, all
of its rows share it. Where each output has an amplifier and a reference of its own, each tap has.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import first_lack, lines, neighbours
from calib.forward.taps import LAYOUTS, check_layout, tap_of_pixel
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class LineNoise(Departure):
    """Shift each line, of a frame each row or all of it, by Gaussian noise, white along time.

    Attributes:
        std_dn: Its standard deviation.
        shared_by: What has one offset, "row" or "frame"; of lines these are the same.
        each_tap: Whether each tap has one of its own, rather than all of them the same.
        tap_layout: Which pixels a tap reads; that of the camera, where each tap has its own.
    """

    name: ClassVar[str] = "line_noise"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = True
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Each line or frame has an offset of its own, white from one to the next, whatever the "
        "signal."
    )
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line",)
    any_law: ClassVar[Variable | None] = "line"

    std_dn: float = parameter(0.5, unit="DN", low=0.0, high=1e5, neutral=0.0)
    shared_by: str = parameter("row", unit="", choices=("row", "frame"))
    each_tap: bool = parameter(False, unit="1")
    tap_layout: str = parameter("single", unit="", choices=LAYOUTS)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:
        """Return what a recording lacks to show it; None where it could."""
        return first_lack(neighbours(camera), lines(blocks, 2))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, (n_lines, *sample)."""
        rows = signal.shape[1:-1] if self.shared_by == "row" else (1,) * (signal.ndim - 2)
        if not self.each_tap:
            return np.asarray(signal + self.std_dn * rng.standard_normal((len(signal), *rows, 1)))
        tap = tap_of_pixel(self.tap_layout, signal.shape[1:])
        shifts = rng.standard_normal((len(signal), *rows, int(tap.max()) + 1))
        of_pixels = np.broadcast_to(shifts, (*signal.shape[:-1], shifts.shape[-1]))
        where = np.broadcast_to(tap, signal.shape)
        return np.asarray(signal + self.std_dn * np.take_along_axis(of_pixels, where, axis=-1))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `tap_layout` is that of the camera, where each tap counts."""
        if self.each_tap:
            check_layout(self.tap_layout, camera, "effect line_noise")
