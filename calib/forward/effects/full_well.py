"""Full well: a pixel holds so many electrons and no more.

Source: EMVA Standard 1288, Release 4.0 Linear, saturation; here a hard stop, as with
antiblooming.
"""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter


@dataclass(frozen=True)
class FullWell(Effect):
    """Stop each pixel's charge at the full well.

    Attributes:
        electrons: The most that a pixel holds.
    """

    name: ClassVar[str] = "full_well"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True

    electrons: float = parameter(30_000.0, unit="e-", low=1.0, neutral=inf)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        return np.minimum(signal, self.electrons)
