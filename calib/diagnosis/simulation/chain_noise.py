"""The noise of the links of a fitted chain: the same in every run, about whatever baseline."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.designed_noise import DesignedNoise
from calib.diagnosis.simulation.designed_normals import SOURCES, designed_normals
from calib.diagnosis.simulation.stack import Stack
from calib.forward.effect import Effect

Floats = NDArray[np.float64]

NOISY_LINKS = ("shot_noise", "read_noise")
"""Of the baseline."""
OF_EFFECTS = 5
"""Sets of sources that effects with noise of their own take; rounding has the next one."""
KEPT_SAMPLES = 1 << 22
"""Numbers, or a signal, of so many samples are kept for the next run; more are made anew."""


@dataclass(frozen=True)
class ChainNoise:
    """What links draw in the lines that are simulated.

    Attributes:
        table: The blocks' conditions.
        sensor: The sensor.
        seed: Of all generators.
    """

    table: ConditionsTable
    sensor: Sensor
    seed: int = 0

    def has_events(self, effect: Effect) -> bool:
        """Return whether chance has a part in an effect: noise that moments do not tell."""
        if not effect.stochastic:
            return False
        if effect.name not in self._events:
            at, shape = self.table.at(0, np.arange(2.0)), (2, *self.sensor.sample)
            rng = DesignedNoise([self.seed], shape, (0,), 0, noise=1.0)
            effect.apply(np.full(shape, 100.0), at, rng)
            self._events[effect.name] = rng.events
        return self._events[effect.name]

    def has_noise(self, effect: Effect) -> bool:
        """Return whether an effect adds noise of its own that moments tell."""
        divides = getattr(effect, "partition_noise", 1.0) > 0.0
        return effect.stochastic and divides and not self.has_events(effect)

    def normals(self, stack: Stack, link: Effect, draw: int) -> Floats:
        """Return the normal numbers of a noisy link of the baseline, (n_lines, *sample)."""
        return self._of(stack, link.name, NOISY_LINKS.index(link.name), draw)

    def of_rounding(self, stack: Stack, draw: int) -> Floats:
        """Return the normal numbers that stand for rounding, (n_lines, *sample)."""
        return self._of(stack, "rounding", SOURCES * (1 + OF_EFFECTS), draw)

    def _of(self, stack: Stack, name: str, source: int, draw: int) -> Floats:
        key = stack.key, name, draw
        if key in self._numbers:
            return self._numbers[key]
        sample = self.sensor.sample
        found = np.concatenate(
            [
                designed_normals(a.n_lines, sample, b + 13 * draw, source)
                for b, a in zip(stack.blocks, stack.at, strict=True)
            ]
        )
        if found.size <= KEPT_SAMPLES:
            self._numbers[key] = found
        return found

    def of_effect(
        self,
        effect: Effect,
        blocks: Sequence[int],
        draw: int,
        shape: tuple[int, ...],
        noise: float,
    ) -> DesignedNoise:
        """Return what answers an effect for lines of `shape` of some blocks."""
        name = crc32(effect.name.encode())
        # Sources of noise beyond the baseline's own take arrays of their own.
        source, which = SOURCES * (1 + name % OF_EFFECTS), [b + 13 * draw for b in blocks]
        seed = [self.seed, name, blocks[0], draw]
        return DesignedNoise(seed, shape, which, source, noise=noise)

    @cached_property
    def _numbers(self) -> dict[tuple[str, str, int], Floats]:
        return {}

    @cached_property
    def _events(self) -> dict[str, bool]:
        return {}
