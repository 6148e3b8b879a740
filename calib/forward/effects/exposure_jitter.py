"""Exposure jitter: each line is exposed for a little longer or shorter than the one before.

Source: EMVA Standard 1288, Release 4.0 Linear, the temporal variance from two images: it takes off
what the difference of their means adds, since light and exposure vary from image to image.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns, Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import flats
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class ExposureJitter(Departure):
    """Scale each line's, or frame's, light by 1 + relative_std z, z normal and white.

    The dark charge is left as it is: its share, relative_std x dark charge, lies below an electron
    wherever the dark charge lies below 1 / relative_std electrons.

    Attributes:
        relative_std: Standard deviation of the exposure time relative to it.
        constant: What is the same at all exposures: "share", that relative one, as of a clock that
            wanders; or "time", as of edges that come early or late, and then it is the relative one
            at `reference_us`.
        reference_us: That exposure.
    """

    name: ClassVar[str] = "exposure_jitter"
    stage: ClassVar[Stage] = Stage.EXPOSURE
    stochastic: ClassVar[bool] = True
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "The exposure time jitters from line to line, alike in all columns: t -> t (1 + e)."
    )
    shows_in: ClassVar[Statistic] = "column_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line", "signal")

    relative_std: float = parameter(0.002, unit="1", low=0.0, high=0.2, neutral=0.0)
    constant: str = parameter("share", unit="", choices=("share", "time"))
    reference_us: float = parameter(1000.0, unit="us", low=1e-3, high=1e9)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Radiance x us in and out, (n_lines, *sample)."""
        return signal * by_line(self.line_factor(at, rng), signal.ndim)

    def line_factor(self, at: Conditions, rng: Generator) -> Columns:
        """Return each line's exposure relative to the mean, (n_lines,)."""
        std = self.relative_std
        if self.constant == "time":
            std = std * self.reference_us / at.exposure_us
        return np.maximum(1.0 + std * rng.standard_normal(at.n_lines), 0.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: lines of a flat that differ."""
        return flats(blocks, lines=2)
