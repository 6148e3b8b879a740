"""Physics in no catalogue, of the electronics and of the link."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, drifting_sign
from tests.concealed.generator.mechanisms.drifts import offset_limit
from tests.concealed.generator.scan import Memory, Scan, note
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class GainAfterOtherTap(Mechanism):
    """A tap's gain rises, its neighbour's falls, with the neighbour's mean of the sample before."""

    name: ClassVar[str] = "gain_after_other_tap"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 8.0 * setting.mean_limit, 1500.0 * setting.mean_limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "GainAfterOtherTap":
        return cls(strength, shape)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.sensor.n_taps >= 2

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        odd = scan.sensor.taps % 2 == 1
        top = scan.top_e * scan.sensor.gain_dn_per_e
        means = np.stack([signal[:, ~odd].mean(axis=1), signal[:, odd].mean(axis=1)]) / top
        before = np.roll(means, 1, axis=1)
        before[:, 0] = memory.get(self.name, np.zeros(2))
        memory[self.name] = means[:, -1]
        rise = np.where(odd, before[0][:, np.newaxis, np.newaxis],
                        -before[1][:, np.newaxis, np.newaxis])  # fmt: skip
        return np.asarray(signal * (1.0 + self.strength * rise))


@dataclass(frozen=True)
class CounterOffset(Mechanism):
    """The offset follows two bits of the camera's counter of samples."""

    name: ClassVar[str] = "counter_offset"
    stage: ClassVar[Stage] = Stage.OFFSET
    unit: ClassVar[str] = "DN"

    bits: tuple[int, int]

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 3.0 * offset_limit(setting), 500.0 * offset_limit(setting)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "CounterOffset":
        first = int(rng.integers(0, 2))
        return cls(strength, shape, (first, first + int(rng.integers(2, 4))))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        low, high = ((scan.counter >> bit) & 1 for bit in self.bits)
        return np.asarray(signal + self.strength * ((low ^ high) - 0.5) * 2.0)


@dataclass(frozen=True)
class SupplyDroop(Mechanism):
    """A bright line draws the supply down, the more the later a column is read: as its square."""

    name: ClassVar[str] = "supply_droop"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "of the brightest signal"

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 10.0 * setting.mean_limit, 1500.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "SupplyDroop":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        top = scan.top_e * scan.sensor.gain_dn_per_e
        share = signal.mean(axis=2, keepdims=True) / top
        late = np.cos(np.pi * np.linspace(0.0, 1.0, scan.sensor.columns))
        return np.asarray(signal + self.strength * top * late * share**2)


@dataclass(frozen=True)
class LinkErrors(Mechanism):
    """Two neighbouring bits of a code change places, at a rate that follows the signal."""

    name: ClassVar[str] = "link_errors"
    stage: ClassVar[Stage] = Stage.CODES
    unit: ClassVar[str] = "per code"

    bit: int

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 2.0 / setting.n_all, 0.03 + 100.0 / sqrt(setting.n_all) * 0.1

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "LinkErrors":
        return cls(strength, shape, int(rng.integers(2, setting.sensor.bit_depth - 3)))

    def changed(self, codes: Pixels) -> Pixels:
        """Return `codes` with the two bits in each other's place."""
        differ = ((codes >> self.bit) ^ (codes >> (self.bit + 1))) & 1
        return np.asarray(codes ^ (differ * (3 << self.bit)))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        chance = self.strength * signal / scan.sensor.top_code
        codes = np.where(rng.random(scan.shape) < chance, self.changed(signal), signal)
        note(memory, self.name, int((codes != signal).sum()))
        return codes


@dataclass(frozen=True)
class PingPongGain(Mechanism):
    """Two converters take turns, sample by sample, at the even columns alone; gains differ."""

    name: ClassVar[str] = "ping_pong_gain"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"

    sign: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 4.0 * setting.mean_limit, 800.0 * setting.mean_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "PingPongGain":
        return cls(strength, shape, drifting_sign(rng))

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        turn = 1.0 - 2.0 * (scan.counter % 2)
        even = np.arange(scan.sensor.columns) % 2 == 0
        return np.asarray(signal * (1.0 + self.sign * self.strength * turn * even))
