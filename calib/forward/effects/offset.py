"""Offset: the DN of no charge, DN0, in each pixel and tap.

Source: Olsen et al., Radiometric calibration for AgCam (2010), Equation 1 and section 5.1, where
most columns lie near the mean and a few far below it, some even below 0.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import (
    check_length,
    explicit_pattern,
    pattern_generator,
    pixel_count,
)
from calib.forward.taps import LAYOUTS, by_tap, check_taps
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Offset(Effect):
    """Add DN0 and the camera's black level, which acts through this link alone.

    DN0 is the mean plus a fixed Gaussian pattern, less an exponentially distributed depth in a
    share of pixels; the pattern is shifted so that its mean over the pixels is `mean_dn`.

    Attributes:
        mean_dn: Mean over the pixels, taps left aside.
        pattern_std_dn: Standard deviation of the Gaussian pattern.
        low_share: Share of the pixels that lie lower.
        low_depth_dn: Mean depth of those.
        pattern_seed: Which sensor of that kind it is.
        pattern_dn: DN0 of each pixel, (*sample,); where given, in place of all of the above.
        tap_offset_dn: What each tap adds; empty where they add nothing.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    name: ClassVar[str] = "offset"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False

    mean_dn: float = parameter(64.0, unit="DN", low=-1e5, high=1e5, neutral=0.0)
    pattern_std_dn: float = parameter(1.0, unit="DN", low=0.0, high=1e4, neutral=0.0)
    low_share: float = parameter(0.0, unit="1", low=0.0, high=1.0, neutral=0.0)
    low_depth_dn: float = parameter(0.0, unit="DN", low=0.0, high=1e4)
    pattern_seed: int = parameter(0, unit="1", low=0)
    pattern_dn: tuple[float, ...] = parameter((), unit="DN", low=-1e5, high=1e5)
    tap_offset_dn: tuple[float, ...] = parameter((), unit="DN", low=-1e4, high=1e4, neutral=())
    tap_layout: str = parameter("single", unit="", choices=LAYOUTS)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in, DN out, (n_lines, *sample)."""
        return signal + self.pixels(signal.shape[1:], at.black_level_dn)

    def pixels(self, sample: SampleShape, black_level_dn: float) -> Pixels:
        """Return DN0 of each pixel with the camera's black level, (*sample,)."""
        fixed = (
            explicit_pattern(self.pattern_dn, sample) if self.pattern_dn else _drawn(self, sample)
        )
        if self.tap_offset_dn:
            fixed = fixed + by_tap(self.tap_offset_dn, self.tap_layout, sample)
        return fixed + black_level_dn

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless there is one value per pixel and per tap of the camera."""
        check_length(self.pattern_dn, pixel_count(camera), "effect offset: pattern_dn")
        check_taps(self.tap_offset_dn, self.tap_layout, camera, "effect offset: tap_offset_dn")


@lru_cache(maxsize=32)
def _drawn(offset: Offset, sample: SampleShape) -> Pixels:
    """Return the fixed pattern, (*sample,), read-only."""
    rng = pattern_generator(offset.pattern_seed, offset.name)
    pattern = offset.pattern_std_dn * rng.standard_normal(sample)
    low = rng.random(sample) < offset.low_share
    pattern -= np.where(low, offset.low_depth_dn * rng.standard_exponential(sample), 0.0)
    pattern += offset.mean_dn - pattern.mean()
    pattern.flags.writeable = False
    return pattern
