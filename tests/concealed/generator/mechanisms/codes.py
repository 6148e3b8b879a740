"""The converter and the link: codes that are wrong, stuck, cut off or sent twice."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage
from tests.concealed.generator.scan import Memory, Scan, note
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class AdcInl(Mechanism):
    """The converter's characteristic strays smoothly from a line; `strength` is by how much."""

    name: ClassVar[str] = "adc_inl"
    stage: ClassVar[Stage] = Stage.CONVERSION
    unit: ClassVar[str] = "DN"
    shapes: ClassVar[tuple[str, ...]] = ("sine",)
    foreign: ClassVar[tuple[str, ...]] = ("broken_line", "sawtooth")

    periods: float
    phase_rad: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.mean_limit * setting.middle_e * setting.sensor.gain_dn_per_e
        return 2.0 * limit, 600.0 * limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "AdcInl":
        return cls(strength, shape, rng.uniform(1.5, 3.5), rng.uniform(0.0, 2 * np.pi))

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.n_levels * setting.n_exposures >= 5

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        turns = self.periods * signal / scan.sensor.top_code + self.phase_rad / (2 * np.pi)
        if self.shape == "sine":
            return signal + self.strength * np.sin(2 * np.pi * turns)
        if self.shape == "sawtooth":
            return signal + self.strength * (2.0 * np.mod(turns, 1.0) - 1.0)
        return signal + self.strength * (4.0 * np.abs(np.mod(turns, 1.0) - 0.5) - 1.0)


@dataclass(frozen=True)
class AdcDnl(Mechanism):
    """Codes are wider or narrower than one DN; `strength` is by how much."""

    name: ClassVar[str] = "adc_dnl"
    stage: ClassVar[Stage] = Stage.QUANTISATION
    unit: ClassVar[str] = "DN"
    shapes: ClassVar[tuple[str, ...]] = ("alternating", "every_fourth", "random")
    foreign: ClassVar[tuple[str, ...]] = ("carry",)

    edges: NDArray[np.float64]
    """Edge k lies between the codes k and k + 1."""

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.7 / sqrt(setting.n_all), 0.95

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "AdcDnl":
        code = np.arange(setting.sensor.top_code)
        moved = {
            "alternating": 0.5 * (-1.0) ** code,
            "every_fourth": np.where(code % 4 == 0, 0.75, -0.25),
            "random": np.clip(0.5 * rng.standard_normal(code.size), -0.5, 0.5),
            "carry": np.where(code % 16 == 7, 0.5, 0.0),
        }[shape]
        return cls(strength, shape, code + 0.5 + strength * moved)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        return np.searchsorted(self.edges, signal)

    def told(self) -> dict[str, object]:
        return {"strength": self.strength}


@dataclass(frozen=True)
class StuckBit(Mechanism):
    """One bit sticks; `strength` is the chance that it does so in a pixel."""

    name: ClassVar[str] = "stuck_bit"
    stage: ClassVar[Stage] = Stage.CODES
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("to_one", "to_zero", "one_tap")
    foreign: ClassVar[tuple[str, ...]] = ("copies_next", "inverts")

    bit: int

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.1 / setting.n_all, 1.0

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "StuckBit":
        return cls(min(1.0, strength), shape, int(rng.integers(0, setting.sensor.bit_depth - 4)))

    def changed(self, codes: Pixels) -> Pixels:
        """Return what becomes of `codes` where the bit sticks."""
        mask = 1 << self.bit
        if self.shape == "copies_next":
            return np.asarray((codes & ~mask) | (((codes >> (self.bit + 1)) & 1) << self.bit))
        if self.shape == "inverts":
            return np.asarray(codes ^ mask)
        return np.asarray(codes & ~mask if self.shape == "to_zero" else codes | mask)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        stuck = self.changed(signal)
        chance = self.strength * ((scan.sensor.taps == 0) if self.shape == "one_tap" else 1.0)
        codes = np.where(rng.random(scan.shape) < chance, stuck, signal)
        note(memory, self.name, int((codes != signal).sum()))
        return codes


@dataclass(frozen=True)
class BlackClip(Mechanism):
    """Codes end at a black level above 0; `strength` is the share of dark reads below it."""

    name: ClassVar[str] = "black_clip"
    stage: ClassVar[Stage] = Stage.CODES
    unit: ClassVar[str] = "of dark reads"
    shapes: ClassVar[tuple[str, ...]] = ("hard", "one_tap")
    foreign: ClassVar[tuple[str, ...]] = ("half_scale",)

    black_dn: int

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.3 / setting.n_dark**0.75, 0.9

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "BlackClip":
        spread = setting.noise_dn * rng.standard_normal((256, 1, 1))
        reads = np.sort((setting.sensor.offset_dn + spread).ravel())
        place = min(int(np.ceil(strength * reads.size)), reads.size - 1)
        black = round(float(reads[place]))
        return cls(float(np.mean(reads < black - 0.5)), shape, black)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.has_darks

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        raised = np.maximum(signal, self.black_dn)
        if self.shape == "half_scale":  # below the black level the scale is twice as coarse
            raised = np.maximum(signal, self.black_dn - (self.black_dn - signal) // 2)
        if self.shape == "one_tap":
            return np.where(scan.sensor.taps == 0, raised, signal)
        return raised


@dataclass(frozen=True)
class DuplicatedLines(Mechanism):
    """A sample is sent twice, and all later ones of the block come one later."""

    name: ClassVar[str] = "duplicated_lines"
    stage: ClassVar[Stage] = Stage.TRANSPORT
    unit: ClassVar[str] = "per sample"
    shapes: ClassVar[tuple[str, ...]] = ("whole",)
    foreign: ClassVar[tuple[str, ...]] = ("half", "pairs")

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.3 / setting.n_lines, 0.1

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "DuplicatedLines":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        twice = np.flatnonzero(rng.random(scan.n_samples) < self.strength)
        if self.shape == "half":  # a packet of half a sample comes again in the next one
            sent, half = signal.copy(), scan.sensor.columns // 2
            for k in twice[twice > 0]:
                sent[k, :, half:] = signal[k - 1, :, half:]
            note(memory, self.name, int((twice > 0).sum()))
            return sent
        order = np.arange(scan.n_samples)
        if self.shape == "pairs":
            for k in twice[::-1]:
                order = np.insert(order, min(k + 2, len(order)), order[k : k + 2])
        else:
            order = np.repeat(order, 1 + np.isin(order, twice))
        order = order[: scan.n_samples]
        note(memory, self.name, scan.n_samples - len(np.unique(order)))
        return signal[order]
