"""Physics in no catalogue, of the light and of the wells."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, drifting_sign
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class MovingFringes(Mechanism):
    """A thin window makes fringes along the columns, which move as it warms."""

    name: ClassVar[str] = "moving_fringes"
    stage: ClassVar[Stage] = Stage.PHOTONS
    unit: ClassVar[str] = "1"

    period_columns: float
    turns_per_k: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 1500.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "MovingFringes":
        period = setting.sensor.columns * rng.uniform(0.06, 0.2)
        return cls(strength, shape, period, rng.uniform(0.08, 0.25))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.temperature_spread_k >= 3.0

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        along = np.arange(scan.sensor.columns) / self.period_columns
        turns = along + self.turns_per_k * scan.warmth_k
        return signal * (1.0 + self.strength * np.cos(2 * np.pi * turns))


@dataclass(frozen=True)
class BreathingShading(Mechanism):
    """The source's angular distribution, and so the shading, changes with its level."""

    name: ClassVar[str] = "breathing_shading"
    stage: ClassVar[Stage] = Stage.PHOTONS
    unit: ClassVar[str] = "1"

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 1500.0 * setting.mean_limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "BreathingShading":
        return cls(strength, shape, drifting_sign(rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels >= 3

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        along = np.linspace(-1.0, 1.0, scan.sensor.columns)
        breath = np.cos(np.pi * along) * scan.block.radiance / scan.top_radiance
        return signal * (1.0 + self.sign * self.strength * breath)


@dataclass(frozen=True)
class TurningSource(Mechanism):
    """The source turns before the lens: the shading tilts as time goes."""

    name: ClassVar[str] = "turning_source"
    stage: ClassVar[Stage] = Stage.PHOTONS
    unit: ClassVar[str] = "1"

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 1500.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "TurningSource":
        return cls(strength, shape, drifting_sign(rng))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        along = np.linspace(-1.0, 1.0, scan.sensor.columns)
        return signal * (1.0 + self.sign * self.strength * along * scan.share)


@dataclass(frozen=True)
class RestlessResponse(Mechanism):
    """Each pixel's conversion flickers: read noise that grows with the light."""

    name: ClassVar[str] = "restless_response"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.lit_noise * (2.0 / setting.n_lit) ** 0.25
        return limit, 15.0 * limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "RestlessResponse":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return signal * (1.0 + self.strength * rng.standard_normal(scan.shape))
