"""Responsivity: light becomes charge, in each column a little differently (PRNU).

Source: EMVA Standard 1288, Release 4.0 Linear, for PRNU; Olsen et al., Radiometric calibration
for AgCam (2010), Equation 1, where responsivity times system gain is called QE(i).
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns, Lines
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import check_length, explicit_pattern, normal_pattern
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Responsivity(Effect):
    """Turn radiance x us into expected electrons.

    Attributes:
        electrons_per_radiance_us: At a column of mean responsivity, on the axis.
        prnu_std: Standard deviation of the relative responsivity among columns, Gaussian.
        prnu_seed: Which sensor of that kind it is.
        prnu: Relative responsivity of each column, (n_columns,); where given, in place of the
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
        """Radiance x us in, expected electrons out, (n_lines, n_columns)."""
        return signal * self.columns(signal.shape[-1])

    def columns(self, n_columns: int) -> Columns:
        """Return expected electrons per radiance per us of each column, (n_columns,)."""
        return self.electrons_per_radiance_us * self.relative(n_columns)

    def relative(self, n_columns: int) -> Columns:
        """Return the relative responsivity, (n_columns,); 0 is a dead column."""
        if self.prnu:
            return explicit_pattern(self.prnu)
        drawn = 1.0 + self.prnu_std * normal_pattern(self.prnu_seed, self.name, n_columns)
        return np.maximum(drawn, 0.0)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `prnu` has one value per column."""
        check_length(self.prnu, camera.columns, "effect responsivity: prnu")
