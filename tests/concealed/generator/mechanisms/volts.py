"""Between the pixel and the converter: voltages that reach their neighbours."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from tests.concealed.generator.mechanism import Mechanism, Pixels, Stage
from tests.concealed.generator.scan import Memory, Scan
from tests.concealed.generator.setting import Setting


@dataclass(frozen=True)
class InterpixelCapacitance(Mechanism):
    """Each pixel's voltage takes a share of each neighbour's, after the charge is collected."""

    name: ClassVar[str] = "interpixel_capacitance"
    stage: ClassVar[Stage] = Stage.COUPLING
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("nearest",)
    foreign: ClassVar[tuple[str, ...]] = ("second_neighbours", "columns_only_half")

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.15 * setting.covariance_limit, 30.0 * setting.covariance_limit

    @classmethod
    def draw(
        cls, strength: float, shape: str, setting: Setting, rng: Generator
    ) -> "InterpixelCapacitance":
        return cls(strength, shape)

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        if self.shape == "columns_only_half":  # every other pair of columns shares a contact
            odd = (np.arange(scan.sensor.columns) % 2 == 1).astype(float)
            difference = np.diff(signal, axis=2, append=signal[..., -1:]) * odd
            return np.asarray(signal + self.strength * (difference - _shifted(difference, 2, 1)))
        coupled = signal + self.strength * self._excess(signal, 1)
        if self.shape == "second_neighbours":
            coupled = coupled + 0.5 * self.strength * self._excess(signal, 2)
        return np.asarray(coupled)

    @staticmethod
    def _excess(signal: Pixels, distance: int) -> Pixels:
        """Sum over the neighbours of their voltage minus the pixel's own."""
        total = np.zeros_like(signal)
        for axis in (1, 2):
            if signal.shape[axis] > distance:
                for way in (distance, -distance):
                    total += _neighbour(signal, axis, way) - signal
        return total


def _neighbour(signal: Pixels, axis: int, way: int) -> Pixels:
    """Return the voltage `way` pixels before; a border's pixel is its own neighbour."""
    places = np.arange(signal.shape[axis])
    source = places - way
    inside = (source >= 0) & (source < signal.shape[axis])
    return np.asarray(np.take(signal, np.where(inside, source, places), axis))


def _shifted(signal: Pixels, axis: int, way: int) -> Pixels:
    moved = np.roll(signal, way, axis)
    moved[..., :way] = 0.0
    return moved


@dataclass(frozen=True)
class TapCrosstalk(Mechanism):
    """A tap sees a share of what its neighbour converts at the same moment."""

    name: ClassVar[str] = "tap_crosstalk"
    stage: ClassVar[Stage] = Stage.VOLTS
    unit: ClassVar[str] = "1"
    shapes: ClassVar[tuple[str, ...]] = ("mutual", "previous_pixel")
    foreign: ClassVar[tuple[str, ...]] = ("one_way",)

    @classmethod
    def reach(cls, setting: Setting) -> tuple[float, float]:
        return 0.3 * setting.covariance_limit, 60.0 * setting.covariance_limit

    @classmethod
    def draw(cls, strength: float, shape: str, setting: Setting, rng: Generator) -> "TapCrosstalk":
        return cls(strength, shape)

    @classmethod
    def can_show(cls, setting: Setting) -> bool:
        return setting.sensor.n_taps >= 2

    def act(self, signal: Pixels, scan: Scan, memory: Memory, rng: Generator) -> Pixels:
        seen = signal[..., scan.sensor.partner]
        if self.shape == "one_way":
            seen = seen * (scan.sensor.taps % 2 == 0)
        if self.shape == "previous_pixel":
            for columns in scan.sensor.registers:
                seen[..., columns[1:]] = seen[..., columns[:-1]]
        return signal + self.strength * seen
