"""Noise that is not a pixel's own, and an output stage that bends."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, drifting_sign
from tests.concealed.generator.scan import Memory, Scan, column, note
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class LineNoise(Mechanism):
    """Each sample (line or frame) has an offset of its own."""

    name: ClassVar[str] = "line_noise"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN"
    shapes: ClassVar[tuple[str, ...]] = ("gaussian", "each_tap")
    foreign: ClassVar[tuple[str, ...]] = ("two_valued", "wandering")

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        pixels = setting.sensor.rows * setting.sensor.columns
        limit = setting.noise_dn / sqrt(pixels) / (2 * setting.n_lines) ** 0.25
        return 0.7 * limit, 60.0 * limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "LineNoise":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if self.shape == "each_tap":
            each = rng.standard_normal((scan.n_samples, scan.sensor.n_taps))
            return signal + self.strength * each[:, scan.sensor.taps]
        return signal + self.strength * column(self._course(scan.n_samples, rng))

    def _course(self, n: int, rng: Generator) -> NDArray[np.float64]:
        if self.shape == "two_valued":
            return rng.choice([-1.0, 1.0], n)
        fresh = rng.standard_normal(n)
        if self.shape == "wandering":
            for k in range(1, n):
                fresh[k] = 0.6 * fresh[k - 1] + 0.8 * fresh[k]
        return fresh


@dataclass(frozen=True)
class Banding(Mechanism):
    """A tone of the electronics runs through the pixels as they are read out."""

    name: ClassVar[str] = "banding"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN"
    shapes: ClassVar[tuple[str, ...]] = ("sine",)
    foreign: ClassVar[tuple[str, ...]] = ("square", "two_tones", "unsteady")

    cycles_per_sample: float
    phase_rad: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.noise_dn * sqrt(2.0 / setting.n_all)
        return 1.5 * limit, 120.0 * limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Banding":
        pixels = setting.sensor.rows * setting.sensor.columns
        whole = int(rng.integers(1, pixels // 4))
        return cls(strength, shape, whole + rng.uniform(0.06, 0.94), rng.uniform(0.0, 2 * np.pi))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        pixels = np.arange(scan.sensor.rows * scan.sensor.columns).reshape(scan.sensor.shape)
        within = pixels / pixels.size
        turns = self.cycles_per_sample * (scan.times_s / (scan.line_period_us * 1e-6) + within)
        if self.shape == "unsteady":
            walk = np.cumsum(0.05 * rng.standard_normal(scan.n_samples))
            turns = turns + column(walk)
        angle = 2 * np.pi * np.mod(turns, 1.0) + self.phase_rad
        if self.shape == "square":
            return signal + self.strength * np.sign(np.sin(angle))
        tone = np.sin(angle)
        if self.shape == "two_tones":
            tone = tone + 0.7 * np.sin(angle * 0.731)
        return signal + self.strength * tone


@dataclass(frozen=True)
class RtsPixels(Mechanism):
    """A few pixels jump between two levels; `strength` is the step."""

    name: ClassVar[str] = "rts_pixels"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN"
    shapes: ClassVar[tuple[str, ...]] = ("two_levels",)
    foreign: ClassVar[tuple[str, ...]] = ("three_levels", "bursts")

    places: NDArray[np.intp]
    up_chance: NDArray[np.float64]
    down_chance: NDArray[np.float64]

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.2 * setting.noise_dn, 25.0 * setting.noise_dn

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "RtsPixels":
        n, pixels = int(rng.integers(3, 9)), setting.sensor.rows * setting.sensor.columns
        places = rng.choice(pixels, n, replace=False)
        up, down = 10.0 ** rng.uniform(-1.5, -0.5, (2, n))
        return cls(strength, shape, places, 0.1 * up if shape == "bursts" else up, down)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        steps = 2 if self.shape == "three_levels" else 1
        moved = np.array(signal, dtype=float)
        flat = moved.reshape(scan.n_samples, -1)
        for number in range(steps):
            key = f"{self.name}{number}"
            state = memory.get(key, rng.random(len(self.places)) < 0.5)
            for line in range(scan.n_samples):
                chance = np.where(state, self.down_chance, self.up_chance)
                state = state ^ (rng.random(len(self.places)) < chance)
                flat[line, self.places] += self.strength * state
            memory[key] = state
        return moved


@dataclass(frozen=True)
class Outlying:
    """Reads of a block with noise of another kind: which of its samples, flat, and how much."""

    sample: NDArray[np.intp]
    noise_e: NDArray[np.float64]


@dataclass(frozen=True)
class HeavyTailedNoise(Mechanism):
    """A share `strength` of the reads has noise of another kind."""

    name: ClassVar[str] = "heavy_tailed_noise"
    stage: ClassVar[Stage] = Stage.NOISE
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("mixture",)
    foreign: ClassVar[tuple[str, ...]] = ("laplace", "one_sided")

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        samples = setting.n_dark if setting.has_darks else 0.05 * setting.n_lit
        return 0.1 / samples, min(0.05, 500.0 / samples)

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "HeavyTailedNoise":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        size, sigma = scan.shape, scan.sensor.read_noise_e
        other = rng.random(size) < self.strength
        drawn = int(other.sum())
        noise = np.array(signal)
        if self.shape == "laplace":
            noise[other] = rng.laplace(0.0, 4.0 * sigma, drawn)
        elif self.shape == "one_sided":
            noise[other] = rng.exponential(6.0 * sigma, drawn)
        else:
            noise[other] = 6.0 * sigma * rng.standard_normal(drawn)
        note(memory, self.name, Outlying(np.flatnonzero(other), noise[other]))
        return noise


@dataclass(frozen=True)
class Nonlinearity(Mechanism):
    """The output stage bends; `strength` is the relative loss at the brightest signal."""

    name: ClassVar[str] = "nonlinearity"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("quadratic",)
    foreign: ClassVar[tuple[str, ...]] = ("cubic", "toe", "compression")

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 4.0 * setting.mean_limit, 1000.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Nonlinearity":
        return cls(strength, shape, drifting_sign(rng))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels * setting.n_exposures >= 3

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        top = scan.top_e * scan.sensor.gain_dn_per_e
        share = signal / top
        loss = {"quadratic": share, "cubic": share * np.abs(share),
                "toe": np.exp(-np.abs(share) / 0.15),
                "compression": np.log1p(3.0 * np.abs(share))}[self.shape]  # fmt: skip
        return signal * (1.0 - self.sign * self.strength * loss)
