"""The shutter's time, and how the sensor answers to much or little light."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, drifting_sign
from tests.concealed.generator.scan import Memory, Scan, column
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class ExposureOffset(Mechanism):
    """The shutter is open for longer or shorter than it says, by a constant."""

    name: ClassVar[str] = "exposure_offset"
    stage: ClassVar[Stage] = Stage.EXPOSURE
    unit: ClassVar[str] = "us"
    foreign: ClassVar[tuple[str, ...]] = ("short_only", "ticks")

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.mean_limit * setting.top_exposure_us
        return limit, 300.0 * limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "ExposureOffset":
        shortest = min(block.exposure_us for block in setting.plan.blocks)
        return cls(min(strength, 0.5 * shortest), shape, drifting_sign(rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_exposures >= 2 and (setting.has_darks or setting.n_levels >= 2)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if self.shape == "ticks":  # a clock of period `strength` that only counts whole ticks
            return np.ceil(signal / (2 * self.strength)) * 2 * self.strength
        if self.shape == "short_only" and scan.block.exposure_us > 0.4 * scan.top_exposure_us:
            return signal
        return signal + self.sign * self.strength


@dataclass(frozen=True)
class ExposureJitter(Mechanism):
    """Each sample's exposure differs at random."""

    name: ClassVar[str] = "exposure_jitter"
    stage: ClassVar[Stage] = Stage.EXPOSURE
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("gaussian", "constant_time")
    foreign: ClassVar[tuple[str, ...]] = ("two_valued",)

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        pixels = setting.sensor.rows * setting.sensor.columns
        limit = setting.lit_noise / sqrt(pixels) / (2 * setting.n_lines) ** 0.25
        return 0.5 * limit, 30.0 * limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "ExposureJitter":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if self.shape == "two_valued":
            return signal * (1.0 + self.strength * column(rng.choice([-1.0, 1.0], scan.n_samples)))
        change = self.strength * column(rng.standard_normal(scan.n_samples))
        if self.shape == "constant_time":
            return np.clip(signal + 0.3 * scan.top_exposure_us * change, 0.0, None)
        return signal * np.clip(1.0 + change, 0.0, None)


@dataclass(frozen=True)
class ReciprocityFailure(Mechanism):
    """Half the light for twice the time does not give the same."""

    name: ClassVar[str] = "reciprocity_failure"
    stage: ClassVar[Stage] = Stage.PHOTONS
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("power",)
    foreign: ClassVar[tuple[str, ...]] = ("traps", "bent_power")

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 600.0 * setting.mean_limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "ReciprocityFailure":
        return cls(strength, shape, drifting_sign(rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels >= 3

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if not scan.lit:
            return signal
        local = np.clip(signal / (scan.top_e * scan.block.exposure_us / scan.top_exposure_us),
                        1e-12, None)  # fmt: skip
        change = {"power": np.log(local), "traps": -4.0 / (1.0 + 6.0 * local),
                  "bent_power": -0.6 * np.log(local) ** 2}[self.shape]  # fmt: skip
        return signal * np.exp(self.sign * self.strength * change)
