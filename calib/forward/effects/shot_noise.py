"""Shot noise: charge comes in whole electrons, independently of each other.

Source: EMVA Standard 1288, Release 4.0 Linear: the number of electrons is Poisson distributed.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage


@dataclass(frozen=True)
class ShotNoise(Effect):
    """Draw the electrons; it has no parameters."""

    name: ClassVar[str] = "shot_noise"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = True

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in, electrons out, (n_lines, *sample)."""
        return rng.poisson(np.maximum(signal, 0.0)).astype(np.float64)
