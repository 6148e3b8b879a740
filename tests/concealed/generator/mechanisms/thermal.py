"""Electrons that no photon made: dark current, hot pixels, an amplifier that glows."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting

_KELVIN = 273.15
_BOLTZMANN_EV = 8.617333e-5


def dark_limit(setting: Setting) -> float:
    """Return electrons per µs, in every pixel, that equal their own standard error."""
    samples = setting.n_dark if setting.has_darks else setting.n_lit
    noise = setting.noise_e if setting.has_darks else setting.lit_noise * setting.middle_e
    return noise / sqrt(samples) / setting.top_exposure_us


@dataclass(frozen=True)
class DarkCurrent(Mechanism):
    """Thermal electrons at a rate of each pixel's own; `strength` is the mean rate."""

    name: ClassVar[str] = "dark_current"
    stage: ClassVar[Stage] = Stage.THERMAL
    unit: ClassVar[str] = "e-/us"
    shapes: ClassVar[tuple[str, ...]] = ("gaussian",)
    foreign: ClassVar[tuple[str, ...]] = ("exponential", "gradient")

    relative: NDArray[np.float64]

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 2.0 * dark_limit(setting), 600.0 * dark_limit(setting)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "DarkCurrent":
        return cls(strength, shape, _relative(shape, setting, rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_exposures >= 2 and (setting.has_darks or setting.n_levels >= 2)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return np.asarray(signal + self.strength * self.relative * memory["exposure_us"])


def _relative(shape: str, setting: Setting, rng: Generator) -> NDArray[np.float64]:
    """Return rates relative to their mean, (rows, columns)."""
    size = setting.sensor.shape
    if shape == "exponential":
        return rng.exponential(1.0, size)
    if shape == "gradient":
        return np.broadcast_to(np.linspace(0.2, 1.8, size[1]), size).copy()
    return np.clip(1.0 + 0.1 * rng.standard_normal(size), 0.0, None)


@dataclass(frozen=True)
class DarkCurrentTemperature(Mechanism):
    """Dark current that doubles every few kelvin; `strength` is the rate at the mean."""

    name: ClassVar[str] = "dark_current_temperature"
    stage: ClassVar[Stage] = Stage.THERMAL
    unit: ClassVar[str] = "e-/us"
    shapes: ClassVar[tuple[str, ...]] = ("doubling",)
    foreign: ClassVar[tuple[str, ...]] = ("arrhenius", "surface")

    relative: NDArray[np.float64]
    doubling_k: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 4.0 * dark_limit(setting), 1000.0 * dark_limit(setting)

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "DarkCurrentTemperature":
        return cls(strength, shape, _relative("gaussian", setting, rng), rng.uniform(5.5, 8.5))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.temperature_spread_k >= 3.0 and DarkCurrent.can_show(setting)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        rate = self.strength * self.relative * self._growth(scan)
        return np.asarray(signal + rate * memory["exposure_us"])

    def _growth(self, scan: Scan) -> float:
        """Rate relative to that at the plan's mean temperature."""
        if self.shape == "doubling":
            return float(2.0 ** (scan.warmth_k / self.doubling_k))
        cold, here = (t + _KELVIN for t in (scan.mean_temperature_c, scan.block.temperature_c))
        gap_ev = 1.12 if self.shape == "arrhenius" else 0.56
        power = 3.0 if self.shape == "arrhenius" else 1.5
        exponent = gap_ev / _BOLTZMANN_EV * (1.0 / cold - 1.0 / here)
        return float((here / cold) ** power * np.exp(exponent))


@dataclass(frozen=True)
class HotPixels(Mechanism):
    """A few pixels leak; `strength` is their median rate."""

    name: ClassVar[str] = "hot_pixels"
    stage: ClassVar[Stage] = Stage.THERMAL
    unit: ClassVar[str] = "e-/us"
    foreign: ClassVar[tuple[str, ...]] = ("levelling_off", "clusters")

    rates: NDArray[np.float64]

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = dark_limit(setting) * sqrt(setting.sensor.rows * setting.sensor.columns)
        return 0.5 * limit, 300.0 * limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "HotPixels":
        rows, columns = setting.sensor.shape
        flat = np.zeros(rows * columns)
        places = rng.choice(flat.size, int(rng.integers(3, 9)), replace=False)
        flat[places] = strength * rng.lognormal(0.0, 0.5, len(places))
        if shape == "clusters":
            flat[(places + 1) % flat.size] += 0.6 * flat[places]
        return cls(strength, shape, flat.reshape(rows, columns))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return DarkCurrent.can_show(setting)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        exposure = memory["exposure_us"]
        if self.shape == "levelling_off":  # the junction discharges as it leaks
            full = 0.5 * scan.top_exposure_us
            exposure = full * -np.expm1(-exposure / full)
        return np.asarray(signal + self.rates * exposure)


@dataclass(frozen=True)
class AmplifierGlow(Mechanism):
    """The output amplifier shines on the columns near it; `strength` is the rate beside it."""

    name: ClassVar[str] = "amplifier_glow"
    stage: ClassVar[Stage] = Stage.THERMAL
    unit: ClassVar[str] = "e-/us"
    shapes: ClassVar[tuple[str, ...]] = ("exponential",)
    foreign: ClassVar[tuple[str, ...]] = ("gaussian", "inverse_square")

    end: str
    length_columns: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 6.0 * dark_limit(setting), 2000.0 * dark_limit(setting)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "AmplifierGlow":
        length = setting.sensor.columns * rng.uniform(0.05, 0.2)
        return cls(strength, shape, str(rng.choice(["left", "right"])), float(length))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return DarkCurrent.can_show(setting)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        distance = np.arange(scan.sensor.columns) / self.length_columns
        decay = {"exponential": np.exp(-distance), "gaussian": np.exp(-(distance**2) / 2),
                 "inverse_square": 1.0 / (1.0 + distance) ** 2}[self.shape]  # fmt: skip
        profile = decay if self.end == "left" else decay[::-1]
        return np.asarray(signal + self.strength * profile * memory["exposure_us"])
