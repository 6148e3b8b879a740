"""Charge as it gathers: particles, repelled electrons, wells that fill."""

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage, thinned
from tests.concealed.generator.scan import Memory, Scan, note
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class Track:
    """Charge that a particle leaves in pixels side by side, the first of which is told."""

    sample: int
    row: int
    first: int
    charge_e: NDArray[np.int64]


@dataclass(frozen=True)
class CosmicRays(Mechanism):
    """Particles cross the sensor in short tracks; `strength` is the mean charge of a track."""

    name: ClassVar[str] = "cosmic_rays"
    stage: ClassVar[Stage] = Stage.WELL
    unit: ClassVar[str] = "e-"
    shapes: ClassVar[tuple[str, ...]] = ("short",)
    foreign: ClassVar[tuple[str, ...]] = ("long", "halo")

    events_per_pixel: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 1.5 * setting.noise_e, 0.5 * setting.top_e + 40.0 * setting.noise_e

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "CosmicRays":
        return cls(strength, shape, rng.uniform(15.0, 60.0) / setting.n_all)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        columns = scan.sensor.columns
        hit, tracks = signal.copy(), list[Track]()
        for _ in range(rng.poisson(self.events_per_pixel * signal.size)):
            line, row, first = (int(rng.integers(size)) for size in scan.shape)
            places = np.arange(first, min(first + self._length(rng), columns))
            shares = self._shares(len(places), rng)
            charge = rng.poisson(rng.exponential(self.strength))
            tracks.append(Track(line, row, first, rng.multinomial(charge, shares)))
            hit[line, row, places] += tracks[-1].charge_e
        note(memory, self.name, tracks)
        return hit

    def _length(self, rng: Generator) -> int:
        if self.shape == "halo":
            return 7
        return int(rng.integers(12, 30)) if self.shape == "long" else 1 + int(rng.geometric(0.6))

    def _shares(self, n: int, rng: Generator) -> NDArray[np.float64]:
        if self.shape == "halo":
            weight = np.exp(-np.abs(np.arange(n) - n // 2) / 1.5)
        else:
            weight = rng.exponential(1.0, n) + 1e-6
        return np.asarray(weight / weight.sum())


@dataclass(frozen=True)
class BrighterFatter(Mechanism):
    """The charge that a pixel holds repels what comes next to its neighbours.

    The exposure is taken in steps. Of the electrons that arrive at a pixel in a step, each goes
    over a given border with the chance `strength` times the pixel's charge before the step.
    """

    name: ClassVar[str] = "brighter_fatter"
    stage: ClassVar[Stage] = Stage.COLLECTION
    unit: ClassVar[str] = "1/e-"
    foreign: ClassVar[tuple[str, ...]] = ("far_reaching", "one_sided")

    n_steps: int = 12

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = setting.covariance_limit / setting.middle_e
        return 0.3 * limit, 40.0 * limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "BrighterFatter":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        held = np.zeros(scan.shape, dtype=np.int64)
        expected = np.broadcast_to(signal, scan.shape) / self.n_steps
        # Charge of the step itself repels too; n/(n − 1) makes up for it to first order.
        chance = self.strength * self.n_steps / (self.n_steps - 1)
        for _ in range(self.n_steps):
            arrived = rng.poisson(expected)
            held = held + self._moved(arrived, chance * held, rng)
        return held

    def _moved(self, arrived: Pixels, chance: Pixels, rng: Generator) -> Pixels:
        """Return `arrived` after each electron's chance to go to a neighbour; none is lost."""
        for axis, distance, share in self._ways(arrived.shape[1]):
            leaving = thinned(arrived, 2.0 * share * chance, rng)
            forwards = leaving if self.shape == "one_sided" else thinned(leaving, 0.5, rng)
            arrived = arrived - leaving
            arrived = arrived + reflected_shift(forwards, axis, distance)
            arrived = arrived + reflected_shift(leaving - forwards, axis, -distance)
        return arrived

    def _ways(self, rows: int) -> list[tuple[int, int, float]]:
        ways = [(2, 1, 1.0)] + ([(1, 1, 1.0)] if rows > 1 else [])
        return [*ways, (2, 2, 0.5)] if self.shape == "far_reaching" else ways


def reflected_shift(counts: Pixels, axis: int, distance: int) -> Pixels:
    """Return `counts` moved along `axis`; what would leave the sensor stays where it was.

    >>> reflected_shift(np.array([1, 2, 3]), 0, 1).tolist()
    [0, 1, 5]
    """
    moved = np.roll(counts, distance, axis)
    wrapped = np.arange(distance) if distance > 0 else np.arange(distance, 0)
    inside: list[slice | NDArray[np.intp]] = [slice(None)] * counts.ndim
    inside[axis] = wrapped
    back = np.array(moved[tuple(inside)])
    moved[tuple(inside)] = 0
    inside[axis] = wrapped - distance
    moved[tuple(inside)] += back
    return moved


@dataclass(frozen=True)
class SaturationKnee(Mechanism):
    """A well that is nearly full loses electrons; `strength` is the share lost at the top."""

    name: ClassVar[str] = "saturation_knee"
    stage: ClassVar[Stage] = Stage.WELL
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("linear",)
    foreign: ClassVar[tuple[str, ...]] = ("square", "constant")

    knee_e: NDArray[np.float64]
    top_e: float

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        limit = 1.0 / sqrt(setting.top_e * setting.n_lit)
        return 30.0 * limit, min(0.9, 10_000.0 * limit)

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "SaturationKnee":
        middle = rng.uniform(0.55, 0.75) * setting.top_e
        scatter = 1.0 + 0.02 * rng.standard_normal(setting.sensor.shape)
        return cls(strength, shape, middle * scatter, setting.top_e)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        above = np.clip(signal - self.knee_e.astype(np.int64), 0, None)
        share = above / (self.top_e - self.knee_e)
        power = {"linear": 1.0, "square": 2.0, "constant": 0.0}[self.shape]
        return signal - thinned(above, self.strength * share**power, rng)
