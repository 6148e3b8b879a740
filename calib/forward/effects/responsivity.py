"""Responsivity: light becomes charge, in each pixel a little differently (PRNU).

Source: EMVA Standard 1288, Release 4.0 Linear, for PRNU; Olsen et al., Radiometric calibration
for AgCam (2010), Equation 1, where responsivity times system gain is called QE(i).
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import check_length, explicit_pattern, normal_pattern, pixel_count
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Responsivity(Effect):
    """Turn radiance x us into expected electrons.

    Attributes:
        electrons_per_radiance_us: At a pixel of mean responsivity, on the axis.
        prnu_std: Standard deviation of the relative responsivity among pixels, Gaussian.
        prnu_seed: Which sensor of that kind it is.
        prnu: Relative responsivity of each pixel, (*sample,); where given, in place of the
            drawn one.
    """

    name: ClassVar[str] = "responsivity"
    stage: ClassVar[Stage] = Stage.PHOTONS
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True

    electrons_per_radiance_us: float = parameter(
        10.0, unit="e-/(radiance us)", low=0.0, high=1e12, neutral=1.0
    )
    prnu_std: float = parameter(0.01, unit="1", low=0.0, high=0.2, neutral=0.0)
    prnu_seed: int = parameter(0, unit="1", low=0)
    prnu: tuple[float, ...] = parameter((), unit="1", low=0.0, high=100.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance x us in, expected electrons out, (n_lines, *sample)."""
        return signal * self.pixels(signal.shape[1:])

    def pixels(self, sample: SampleShape) -> Pixels:
        """Return expected electrons per radiance per us of each pixel, (*sample,)."""
        return self.electrons_per_radiance_us * self.relative(sample)

    def relative(self, sample: SampleShape) -> Pixels:
        """Return the relative responsivity, (*sample,); 0 is a dead pixel."""
        if self.prnu:
            return explicit_pattern(self.prnu, sample)
        drawn = 1.0 + self.prnu_std * normal_pattern(self.prnu_seed, self.name, sample)
        return np.maximum(drawn, 0.0)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `prnu` has one value per pixel."""
        check_length(self.prnu, pixel_count(camera), "effect responsivity: prnu")
