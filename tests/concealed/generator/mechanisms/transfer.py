"""Charge on its way: left for the next line, trapped, left behind in the register."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, thinned
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class Lag(Mechanism):
    """A share `strength` of a pixel's charge stays for the next sample.

    Where each electron stays or goes by a chance of its own, light remains Poisson-distributed and
    lines stay independent: such lag shows after a step of the light alone. Where a reset ends too
    early the share is that of the whole charge, and lines correlate.
    """

    name: ClassVar[str] = "lag"
    stage: ClassVar[Stage] = Stage.TRANSFER
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("each_electron", "incomplete_reset")
    foreign: ClassVar[tuple[str, ...]] = ("small_charge", "barrier")

    half_e: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        pixels = setting.sensor.rows * setting.sensor.columns
        steps = 0.25 * setting.top_e * pixels * len(setting.plan.flats)
        return 0.3 / sqrt(steps), 150.0 / sqrt(steps)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Lag":
        return cls(strength, shape, 0.3 * setting.top_e)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        left = memory.get(self.name, np.zeros(scan.sensor.shape, dtype=np.int64))
        read = np.empty(scan.shape, dtype=signal.dtype)
        for line, fresh in enumerate(np.broadcast_to(signal, scan.shape)):
            held = fresh + left
            left = self._left(held, rng)
            read[line] = held - left
        memory[self.name] = left
        return read

    def _left(self, held: Pixels, rng: Generator) -> Pixels:
        if self.shape == "incomplete_reset":  # whole electrons, without a bias
            whole, rest = np.divmod(self.strength * held, 1.0)
            return whole.astype(held.dtype) + thinned(np.ones_like(held), rest, rng)
        return thinned(held, self.strength * self.relative(held), rng)

    def relative(self, held: Pixels) -> Pixels | float:
        """Return the chance to stay over `strength`."""
        if self.shape == "small_charge":  # shallow traps that a large charge does not notice
            return np.asarray(2.0 / (1.0 + held / self.half_e))
        if self.shape == "barrier":  # only what lies above a barrier waits
            return np.asarray(2.0 * np.clip(held - self.half_e, 0, None) / np.maximum(held, 1))
        return 1.0


@dataclass(frozen=True)
class Persistence(Mechanism):
    """Traps fill in the light and let go at random; `strength` is their number in a pixel."""

    name: ClassVar[str] = "persistence"
    stage: ClassVar[Stage] = Stage.TRANSFER
    unit: ClassVar[str] = "traps"
    shapes: ClassVar[tuple[str, ...]] = ("one_time",)
    foreign: ClassVar[tuple[str, ...]] = ("two_times", "many_times")

    time_s: float
    filled_by_e: float
    """Charge that fills a trap in one sample with the chance 1 − 1/e."""

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        samples_in_time = cls._pause_s(setting) / (setting.plan.line_period_us * 1e-6)
        limit = 3.0 * setting.noise_e / sqrt(setting.n_dark) * samples_in_time
        high = min(100.0 * limit, 0.3 * setting.top_e)
        return high / 300.0, high

    @staticmethod
    def _pause_s(setting: Setting) -> float:
        return setting.plan.duration_s / len(setting.plan.blocks)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Persistence":
        time_s = cls._pause_s(setting) * float(rng.uniform(0.3, 1.0))
        return cls(strength, shape, time_s, 20.0 * setting.top_e)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        darker_after = [
            later.kind == "dark" and earlier.kind == "flat"
            for earlier, later in zip(setting.plan.blocks, setting.plan.blocks[1:], strict=False)
        ]
        return any(darker_after)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        times_s = self._times()
        kept = memory.setdefault(self.name, self._empty(scan, len(times_s), rng))
        pause_s = scan.block.started_s - kept["until_s"]
        read = np.empty(scan.shape, dtype=signal.dtype)
        for line, fresh in enumerate(np.broadcast_to(signal, scan.shape)):
            elapsed_s = pause_s if line == 0 else scan.line_period_us * 1e-6
            charge = fresh.copy()
            for k, time_s in enumerate(times_s):
                freed = thinned(kept["filled"][k], -np.expm1(-elapsed_s / time_s), rng)
                free = kept["traps"][k] - kept["filled"][k] + freed
                caught = thinned(free, -np.expm1(-fresh / self.filled_by_e), rng)
                caught = np.minimum(caught, charge)
                kept["filled"][k] += caught - freed
                # What is let go in a pause between blocks is cleared with the idle lines.
                charge = charge - caught + (0 if line == 0 else freed)
            read[line] = charge
        kept["until_s"] = scan.block.started_s + scan.n_samples * scan.line_period_us * 1e-6
        return read

    def _times(self) -> tuple[float, ...]:
        if self.shape == "many_times":
            return tuple((self.time_s * np.geomspace(0.05, 10.0, 5)).tolist())
        return (
            (0.2 * self.time_s, 3.0 * self.time_s) if self.shape == "two_times" else (self.time_s,)
        )

    def _empty(self, scan: Scan, n_kinds: int, rng: Generator) -> dict[str, object]:
        size = (n_kinds, *scan.sensor.shape)
        traps = rng.poisson(self.strength / n_kinds, size)
        return {"traps": traps, "filled": np.zeros_like(traps), "until_s": 0.0}


@dataclass(frozen=True)
class Cti(Mechanism):
    """Each transfer leaves a share of the charge behind; `strength` is that at `reference_e`.

    A packet's transfers are taken in groups of `group`, its losses drawn group by group and given
    to the packet behind it, which may lose them in turn.
    """

    name: ClassVar[str] = "cti"
    stage: ClassVar[Stage] = Stage.TRANSFER
    unit: ClassVar[str] = "1 per transfer"
    shapes: ClassVar[tuple[str, ...]] = ("small_charge", "constant")
    foreign: ClassVar[tuple[str, ...]] = ("surface", "fixed_traps")

    reference_e: float
    group: int = 32

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.covariance_limit / (setting.sensor.columns / 3)
        return 0.5 * limit, min(150.0 * limit, 0.8 / setting.sensor.columns)

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "Cti":
        return cls(strength, shape, 0.3 * setting.top_e)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        read = np.array(np.broadcast_to(signal, scan.shape))
        for columns in scan.sensor.registers:
            read[..., columns] = self._through(read[..., columns], rng)
        return read

    def _through(self, packets: Pixels, rng: Generator) -> Pixels:
        """Return packets, the output's neighbour first, after their transfers."""
        n_transfers = np.arange(1, packets.shape[-1] + 1)
        for first in range(0, packets.shape[-1], self.group):
            n_here = np.clip(n_transfers - first, 0, self.group)
            behind = thinned(packets, -np.expm1(n_here * np.log1p(-self.share(packets))), rng)
            packets = packets - behind
            packets[..., 1:] += behind[..., :-1]
        return packets

    def share(self, packets: Pixels) -> Pixels:
        """Return what a transfer leaves behind, relative to the charge."""
        charge = np.maximum(packets, 1) / self.reference_e
        power = {"small_charge": -0.4, "constant": 0.0, "surface": 0.5, "fixed_traps": -1.0}
        return np.clip(self.strength * charge ** power[self.shape], 0.0, 0.02)
