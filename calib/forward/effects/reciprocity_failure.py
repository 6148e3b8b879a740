"""Reciprocity failure: a bright light for a short time gives more than a dim one for long.

Source: Hill et al., Reciprocity failure in 1.7 um cut-off HgCdTe detectors, Proc. SPIE 7742,
774222 (2010): a power law of the flux over five decades, 0.3 to 1 % a decade in the detectors of
WFC3, 6 % a decade in those of NICMOS. A decade gives 10^exponent - 1. Traps that fill faster at a
higher flux keep less of it.
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
from calib.forward.plan_needs import light_against_level
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class ReciprocityFailure(Departure):
    """Scale radiance x us by (radiance / reference)^exponent, the radiance that a pixel sees.

    Attributes:
        exponent: gamma in response ~ L^(1 + gamma) t.
        reference_radiance: Where the response is that of the model without this link.
    """

    name: ClassVar[str] = "reciprocity_failure"
    stage: ClassVar[Stage] = Stage.PHOTONS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "The response follows a power of the light, not the light: L t -> L (L / L_0)^g t."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("level",)
    smooth_law: ClassVar[Variable | None] = "level"

    exponent: float = parameter(0.004, unit="1", low=-0.5, high=0.5, neutral=0.0)
    reference_radiance: float = parameter(10.0, unit="radiance", low=1e-12, high=1e12)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance x us in and out, (n_lines, *sample); no light stays none."""
        lit = signal > 0
        relative = signal[lit] / (at.exposure_us * self.reference_radiance)
        bent = np.zeros(signal.shape)
        bent[lit] = signal[lit] * relative**self.exponent
        return bent

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: levels whose light can be compared."""
        return light_against_level(blocks)
