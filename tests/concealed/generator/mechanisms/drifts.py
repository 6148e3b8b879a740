"""Gains and offsets that change with time and temperature."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator import courses
from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, drifting_sign
from tests.concealed.generator.mechanisms.drifting import Drifting
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class GainDrift(Drifting):
    """The system gain takes a course in time, at all taps alike."""

    name: ClassVar[str] = "gain_drift"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 2.0 * setting.mean_limit, 12.0 * setting.covariance_limit

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return signal * (1.0 + self.change(scan))


@dataclass(frozen=True)
class TapGainDrift(Drifting):
    """One tap's gain drifts against the others'."""

    name: ClassVar[str] = "tap_gain_drift"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"

    tap: int

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 500.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "TapGainDrift":
        tap = int(rng.integers(setting.sensor.n_taps))
        return cls(strength, shape, drifting_sign(rng), courses.draw_constant(rng), tap)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.sensor.n_taps >= 2

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        here = scan.sensor.taps == self.tap
        return np.asarray(signal * (1.0 + self.change(scan) * (here - here.mean())))


@dataclass(frozen=True)
class OffsetDrift(Drifting):
    """The offset takes a course in time."""

    name: ClassVar[str] = "offset_drift"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = offset_limit(setting)
        return 2.0 * limit, 500.0 * limit

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return signal + self.change(scan)


@dataclass(frozen=True)
class OffsetTemperature(Mechanism):
    """The offset follows the sensor's temperature."""

    name: ClassVar[str] = "offset_temperature"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN/K"
    shapes: ClassVar[tuple[str, ...]] = ("linear",)
    foreign: ClassVar[tuple[str, ...]] = ("quadratic", "threshold")

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = offset_limit(setting) / max(setting.temperature_spread_k, 0.1)
        return 3.0 * limit, 800.0 * limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "OffsetTemperature":
        return cls(strength, shape, drifting_sign(rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.temperature_spread_k >= 3.0

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        warmth = scan.warmth_k
        change = {"linear": warmth, "quadratic": warmth + 0.3 * warmth * abs(warmth),
                  "threshold": max(0.0, warmth) * 2.0}[self.shape]  # fmt: skip
        return signal + self.sign * self.strength * change


def offset_limit(setting: Setting) -> float:
    """Return a common offset, DN, that equals its own standard error."""
    if setting.has_darks:
        return setting.noise_dn / sqrt(setting.n_dark)
    lit_dn = setting.lit_noise * setting.middle_e * setting.sensor.gain_dn_per_e
    return lit_dn / sqrt(setting.n_lit)
