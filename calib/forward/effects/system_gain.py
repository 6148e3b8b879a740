"""System gain: electrons become DN, in each tap with a gain of its own.

Source: EMVA Standard 1288, Release 4.0 Linear, overall system gain K in DN/e-. The camera's own
gain setting multiplies it by 10^(dB / 20), an amplitude ratio.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.forward.taps import LAYOUTS, by_tap, check_taps
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class SystemGain(Effect):
    """Turn electrons into DN.

    Attributes:
        dn_per_e: System gain at the camera's gain setting 0 dB.
        tap_gain: Each tap's gain relative to that; empty where all are alike.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    name: ClassVar[str] = "system_gain"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False

    dn_per_e: float = parameter(0.1, unit="DN/e-", low=1e-9, high=1e6, neutral=1.0)
    tap_gain: tuple[float, ...] = parameter((), unit="1", low=0.01, high=100.0, neutral=())
    tap_layout: str = parameter("single", unit="", choices=LAYOUTS)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in, DN above the offset out, (n_lines, *sample)."""
        return signal * self.pixels(signal.shape[1:], at.gain_db)

    def pixels(self, sample: SampleShape, gain_db: float) -> Pixels:
        """Return each pixel's system gain, DN/e-, (*sample,)."""
        gain = self.dn_per_e * float(10.0 ** (gain_db / 20.0))
        if not self.tap_gain:
            return np.full(sample, gain)
        return by_tap(self.tap_gain, self.tap_layout, sample) * gain

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `tap_gain` has one value per tap of the camera."""
        check_taps(self.tap_gain, self.tap_layout, camera, "effect system_gain: tap_gain")
