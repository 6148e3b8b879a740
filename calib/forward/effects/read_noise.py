"""Read noise: the output stage adds noise of its own, referred to electrons.

Source: EMVA Standard 1288, Release 4.0 Linear, the signal-independent part of the temporal dark
noise; Gaussian, white.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter


@dataclass(frozen=True)
class ReadNoise(Effect):
    """Add Gaussian noise to the electrons.

    Attributes:
        std_e: Its standard deviation.
    """

    name: ClassVar[str] = "read_noise"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = True

    std_e: float = parameter(10.0, unit="e-", low=0.0, high=1e6, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        return np.asarray(signal + self.std_e * rng.standard_normal(signal.shape))
