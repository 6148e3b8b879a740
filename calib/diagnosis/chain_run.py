"""Runs the fitted chain with and without effects, on few lines of every block.

The links draw from generators of their own, the same in every run, so that the difference of two
runs is what an effect does and not what chance does. Codes are rounded only for effects of codes:
rounding would hide small changes of a single sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.baseline import Baseline
from calib.diagnosis.conditions_table import ConditionsTable
from calib.diagnosis.fitted_links import (
    GaussianShotNoise,
    Light,
    PixelGain,
    PixelOffset,
    PixelReadNoise,
    Response,
)
from calib.diagnosis.sensor import Sensor
from calib.forward.chain import expected_left
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.effects.adc import Adc
from calib.forward.effects.catalogue import place_of
from calib.forward.left import Left
from calib.forward.remembering import Remembering

Floats = NDArray[np.float64]
_UNUSED = default_rng(0)
_NOISE = ("shot_noise", "read_noise")


@dataclass(frozen=True)
class FittedChain:
    """The baseline as a chain of links.

    Attributes:
        baseline: As fitted.
        table: The blocks' conditions.
        sensor: The sensor.
        seed: Of all generators.
    """

    baseline: Baseline
    table: ConditionsTable
    sensor: Sensor
    seed: int = 0

    @cached_property
    def links(self) -> tuple[Effect, ...]:
        """The baseline's links in physical order, the conversion to codes last."""
        sample, tap = self.sensor.sample, self.sensor.tap
        gain = self.gain
        read = np.sqrt(self.baseline.read_variance_dn2[tap]) / gain
        return (
            Light(self.table.lamp_radiance),
            Response((self.baseline.slope / gain).reshape(sample)),
            GaussianShotNoise(),
            PixelReadNoise(read.reshape(sample)),
            PixelGain(gain.reshape(sample)),
            PixelOffset(self.baseline.offset_dn.reshape(sample)),
            Adc(self.sensor.camera.bit_depth),
        )

    @property
    def gain(self) -> Floats:
        """System gain of each pixel, DN/e-, (n_rows, n_columns); 1 where it is not determined."""
        gain = self.baseline.gain_dn_per_e[self.sensor.tap]
        return np.where(gain > 0, gain, 1.0)

    @property
    def most_electrons(self) -> float:
        """The largest mean charge in the recording."""
        signal = self.baseline.mean_dn - self.baseline.offset_dn
        return max(float(np.median(signal / self.gain, axis=(1, 2)).max()), 1.0)

    def left_before(self, effects: Sequence[Effect]) -> tuple[Left | None, ...]:
        """Return what each block finds in the pixels on average; None where nothing remembers."""
        if not any(isinstance(effect, Remembering) for effect in effects):
            return (None,) * len(self.table.blocks)
        found: list[Left | None] = []
        left: Left | None = None
        for b, n in enumerate(self.table.n_lines):
            found.append(left)
            left = self.left_after(b, int(n), effects, left)
        return tuple(found)

    def left_after(
        self, b: int, n: int, effects: Sequence[Effect], before: Left | None
    ) -> Left | None:
        """Return what the first `n` lines of block `b` leave on average."""
        at = replace(self.table.at(b, np.arange(n, dtype=np.float64)), before=before)
        return expected_left(self._chain(effects), np.zeros((1, *self.sensor.sample)), at)

    def noise_free(self, at: Conditions, effects: Sequence[Effect], b: int, draw: int) -> Floats:
        """Return the mean DN, (n_lines, n_pixels), of lines under `at`; effects may be random."""
        links = [x for x in self._chain(effects) if x.name not in _NOISE and x.name != "adc"]
        return self._run(links, at, b, draw).reshape(at.n_lines, -1)

    def drawn(self, at: Conditions, effects: Sequence[Effect], b: int, draw: int) -> Floats:
        """Return lines drawn under `at`, (n_lines, n_rows, n_columns)."""
        coded = any(e.stage >= Stage.CODES for e in effects)
        links = [x for x in self._chain(effects) if coded or x.name != "adc"]
        drawn = self._run(links, at, b, draw)
        return drawn.reshape(at.n_lines, self.sensor.n_rows, self.sensor.n_columns)

    def _chain(self, effects: Sequence[Effect]) -> tuple[Effect, ...]:
        return tuple(sorted((*self.links, *effects), key=place_of))

    def _run(self, links: Sequence[Effect], at: Conditions, b: int, draw: int) -> Floats:
        signal: Floats = np.zeros((at.n_lines, *self.sensor.sample))
        exposed = False
        for link in links:
            if not exposed and link.stage > Stage.SOURCE:
                signal, exposed = signal * at.exposure_us, True
            signal = np.asarray(link.apply(signal, at, self._rng(link, b, draw)), np.float64)
            at = link.conditions_after(at)
        return signal

    def _rng(self, link: Effect, b: int, draw: int) -> Generator:
        if not link.stochastic:
            return _UNUSED
        return default_rng([self.seed, crc32(link.name.encode()), b, draw])


def spread_lines(n: int) -> tuple[tuple[Columns, ...], Columns]:
    """Return stretches of lines that stand for a block of `n`, and the weight of each line.

    The first lines count for themselves, since there a step from the block before shows.
    """
    if n <= 16:
        return (np.arange(n, dtype=np.float64),), np.full(n, 1.0 / n)
    starts = (0, n // 8, n // 4, n // 2, 3 * n // 4, n - 2)
    lengths = (6, 1, 1, 2, 1, 2)
    stretches: list[Columns] = []
    for start, length in zip(starts, lengths, strict=True):
        first = max(start, int(stretches[-1][-1]) + 1 if stretches else 0)
        stretches.append(np.arange(first, min(first + length, n), dtype=np.float64))
    lines = np.concatenate(stretches)
    edges = np.concatenate([[-0.5], (lines[1:] + lines[:-1]) / 2, [n - 0.5]])
    return tuple(s for s in stretches if len(s)), np.diff(edges) / n
