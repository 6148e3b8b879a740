"""Illumination: lamps of an integrating sphere, or an LED, whose radiances add.

Source: Olsen et al., Radiometric calibration for AgCam (2010), section 3, item 2: a sphere whose
bulbs are switched on one after the other.
"""

from dataclasses import dataclass
from math import exp
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import check_length
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Illumination(Effect):
    """Add the lamps' radiance to the scene's; a capped lens lets nothing through.

    Attributes:
        radiance: Nominal radiance of each lamp, in the source's unit. An LED is one lamp.
        warm_up_s: Time constant with which each lamp approaches its emission after it is
            switched; empty where they do so at once. The conditions hold the momentary emission;
            only `emission` uses this.
    """

    name: ClassVar[str] = "illumination"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True

    radiance: tuple[float, ...] = parameter((1.0,), unit="radiance", low=0.0, neutral=(0.0,))
    warm_up_s: tuple[float, ...] = parameter((), unit="s", low=0.0, high=36_000.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance of the scene in, radiance at the lens out, (n_lines, *sample)."""
        if at.capped:
            return np.zeros_like(signal)
        return signal + self.total(at.lamps)

    def total(self, emissions: tuple[float, ...]) -> float:
        """Return the radiance of lamps with these relative emissions; missing ones are dark."""
        if len(emissions) > len(self.radiance):
            raise InputError(
                f"effect illumination: {len(emissions)} lamps are lit, but the model has "
                f"{len(self.radiance)}; give each a radiance.",
                code="too-many-lamps",
            )
        return float(sum(e * r for e, r in zip(emissions, self.radiance, strict=False)))

    def emission(self, lamp: int, start: float, target: float, for_s: float) -> float:
        """Return the relative emission of `lamp`, `for_s` after it was sent on its way."""
        tau_s = self.warm_up_s[lamp] if self.warm_up_s else 0.0
        if tau_s == 0.0:
            return target
        return target + (start - target) * exp(-for_s / tau_s)

    def check_camera(self, camera: CameraHeader) -> None:  # noqa: ARG002
        """Raise InputError unless each lamp has a time constant, or none has."""
        check_length(self.warm_up_s, len(self.radiance), "effect illumination: warm_up_s")
