"""The light: it drifts, flickers, adds up to less than its lamps, and comes from elsewhere."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage
from tests.concealed.generator.mechanisms.drifting import Drifting
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class LampDrift(Drifting):
    """The source's radiance takes a course in time."""

    name: ClassVar[str] = "lamp_drift"
    stage: ClassVar[Stage] = Stage.LAMP
    unit: ClassVar[str] = "1"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 2.0 * setting.mean_limit, 500.0 * setting.mean_limit

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return signal * (1.0 + self.change(scan))


@dataclass(frozen=True)
class LampFlicker(Mechanism):
    """The lamp follows the mains' power; the exposure integrates over it."""

    name: ClassVar[str] = "lamp_flicker"
    stage: ClassVar[Stage] = Stage.LAMP
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("sine",)
    foreign: ClassVar[tuple[str, ...]] = ("harmonics", "beating")

    frequency_hz: float
    phase_rad: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * setting.mean_limit, 400.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "LampFlicker":
        mains = float(rng.choice([50.0, 60.0])) * (1.0 + 0.0005 * rng.standard_normal())
        return cls(strength, shape, 2.0 * mains, float(rng.uniform(0.0, 2 * np.pi)))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        parts = {"sine": ((1.0, 1.0),), "harmonics": ((1.0, 0.8), (2.0, 0.5), (3.0, 0.3)),
                 "beating": ((1.0, 0.8), (0.97, 0.6))}[self.shape]  # fmt: skip
        change = sum(share * self._mean_sine(scan, multiple) for multiple, share in parts)
        return signal * (1.0 + self.strength * change)

    def _mean_sine(self, scan: Scan, multiple: float) -> Pixels:
        """Mean of the sine while the shutter is open."""
        turn = 2 * np.pi * multiple * self.frequency_hz
        opened = turn * scan.times_s + self.phase_rad
        closed = opened + turn * scan.block.exposure_us * 1e-6
        return np.asarray((np.cos(opened) - np.cos(closed)) / (closed - opened))


@dataclass(frozen=True)
class LevelNonadditivity(Mechanism):
    """Lamps that burn together load their supply: each gives less."""

    name: ClassVar[str] = "level_nonadditivity"
    stage: ClassVar[Stage] = Stage.LAMP
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("linear",)
    foreign: ClassVar[tuple[str, ...]] = ("quadratic", "last_lamp")

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 4.0 * setting.mean_limit, 1000.0 * setting.mean_limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "LevelNonadditivity":
        return cls(strength, shape, 1.0 if rng.random() < 0.8 else -1.0)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels >= 3

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        share = scan.block.radiance / scan.top_radiance
        loss = {"linear": share, "quadratic": share**2, "last_lamp": float(share > 0.99)}
        return signal * (1.0 - self.sign * self.strength * loss[self.shape])


@dataclass(frozen=True)
class StrayLight(Mechanism):
    """Light that is not the source's reaches the sensor whenever the cap is off."""

    name: ClassVar[str] = "stray_light"
    stage: ClassVar[Stage] = Stage.AMBIENT
    unit: ClassVar[str] = "of the brightest level"
    shapes: ClassVar[tuple[str, ...]] = ("uniform",)
    foreign: ClassVar[tuple[str, ...]] = ("gradient", "one_side")

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return setting.mean_limit, 400.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "StrayLight":
        return cls(strength, shape)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels >= 2 and setting.n_exposures >= 2

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if not scan.lit:
            return signal
        along = np.linspace(0.0, 1.0, scan.sensor.columns)
        profile = {"uniform": np.ones_like(along), "gradient": 0.4 + 1.2 * along,
                   "one_side": 5.0 * np.exp(-5.0 * along)}[self.shape]  # fmt: skip
        return signal + self.strength * scan.top_radiance * profile
