"""The fitted chain with and without effects: lines of it, and what they leave in the pixels.

Codes are rounded only for effects of codes: rounding would hide small changes of a single sample.
Others get noise of its variance behind all links, where none of them passes it on.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.fitted_links import (
    GaussianShotNoise,
    Light,
    PixelGain,
    PixelOffset,
    PixelReadNoise,
    Response,
)
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_noise import NOISY_LINKS, ChainNoise
from calib.diagnosis.simulation.latest import Latest
from calib.diagnosis.simulation.passage import Passage
from calib.diagnosis.simulation.stack import Stack
from calib.forward.chain import without_noise
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.adc import Adc
from calib.forward.effects.catalogue import place_of
from calib.forward.left import Left
from calib.forward.remembering import Remembering

Floats = NDArray[np.float64]

ROUNDING_DN2 = 1.0 / 12.0
"""Of codes, whose noise reaches over several of them."""


@dataclass(frozen=True)
class FittedChain:
    """The baseline as a chain of links.

    Attributes:
        baseline: As fitted.
        table: The blocks' conditions.
        sensor: The sensor.
        seed: Of all generators.
        known_noise: What was drawn for the links already.
    """

    baseline: Baseline
    table: ConditionsTable
    sensor: Sensor
    seed: int = 0
    known_noise: ChainNoise | None = None

    @cached_property
    def noise(self) -> ChainNoise:
        """The noise of the links, which does not hang on the baseline."""
        return self.known_noise or ChainNoise(self.table, self.sensor, self.seed)

    @cached_property
    def passage(self) -> Passage:
        """What carries a signal through the links, and keeps what stands before effects."""
        return Passage(self.table, self.sensor, self.noise)

    def about(self, baseline: Baseline) -> "FittedChain":
        """Return the chain of another baseline with the same noise."""
        return replace(self, baseline=baseline, known_noise=self.noise)

    @cached_property
    def links(self) -> tuple[Effect, ...]:
        """The baseline's links in physical order, the conversion to codes last."""
        sample, tap = self.sensor.sample, self.sensor.tap
        gain = self.gain
        read = np.sqrt(self.baseline.read_variance_dn2 - self.rounding_dn2)[tap] / gain
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
    def rounding_dn2(self) -> Floats:
        """What rounding has of the read variance, (n_taps,)."""
        return np.minimum(self.baseline.read_variance_dn2, ROUNDING_DN2)

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
        none = (None,) * len(self.table.blocks)
        if not any(isinstance(effect, Remembering) for effect in effects):
            return none
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
        if n == 0 or not any(isinstance(effect, Remembering) for effect in effects):
            return before
        at = replace(self._first_lines(b, n), before=before)
        states = {
            effect.name: effect.expected_left(signals[b][None], at)
            for effect, signals in self._remembered(tuple(effects))
        }
        return Left(at.ended_s, states, drawn=False)

    def _first_lines(self, b: int, n: int) -> Conditions:
        if (b, n) not in self._seen:
            self._seen[b, n] = self.table.at(b, np.arange(n, dtype=np.float64))
        return self._seen[b, n]

    def _remembered(self, effects: tuple[Effect, ...]) -> list[tuple[Remembering, Floats]]:
        """Return effects that remember and what each block brings them, (n_blocks, *sample)."""
        known = self._memory.get(effects)
        if known is not None:
            return known
        middles = [(b, np.array([(n - 1) / 2])) for b, n in enumerate(self.table.n_lines)]
        stack, chain = self.stack(middles, "middle"), self._chain(effects)
        found = [
            (x, self.passage.run(stack, without_noise(chain[:k]), 0, noise=0.0))
            for k, x in enumerate(chain)
            if isinstance(x, Remembering)
        ]
        self._memory.clear()
        self._memory[effects] = found
        return found

    def stack(self, lines: Sequence[tuple[int, Columns]], key: str) -> Stack:
        """Return the stack of (block, lines counted from the block's first); one for each key."""
        if key not in self._stacks:
            self._stacks[key] = Stack.of(self.table, lines, key)
        return self._stacks[key]

    def noise_free(self, stack: Stack, effects: Sequence[Effect], draw: int) -> Floats:
        """Return the mean DN, (n_lines, n_pixels); effects of single events have these drawn."""
        links = [x for x in self._chain(effects) if x.name not in NOISY_LINKS and x.name != "adc"]
        return self.passage.run(stack, links, draw, noise=0.0).reshape(stack.n_lines, -1)

    def drawn(
        self, stack: Stack, effects: Sequence[Effect], draw: int, *, coded: bool, sign: float = 1.0
    ) -> Floats:
        """Return drawn lines, (n_lines, n_rows, n_columns), whole codes where `coded`.

        With `sign` -1, the effects' own noise is the opposite one; that of the baseline is not.
        """
        links = [x for x in self._chain(effects) if coded or x.name != "adc"]
        drawn = self.passage.run(stack, links, draw, noise=sign)
        if not coded:
            std = np.sqrt(self.rounding_dn2)[self.sensor.tap].reshape(self.sensor.sample)
            drawn = drawn + std * self.noise.of_rounding(stack, draw)
        return drawn.reshape(stack.n_lines, self.sensor.n_rows, self.sensor.n_columns)

    def has_events(self, effect: Effect) -> bool:
        """Return whether chance has a part in an effect: noise that moments do not tell."""
        return self.noise.has_events(effect)

    def has_noise(self, effect: Effect) -> bool:
        """Return whether an effect adds noise of its own that moments tell."""
        return self.noise.has_noise(effect)

    @cached_property
    def coded_means(self) -> Latest[Floats]:
        """By how much the last effects of codes move all means, DN, (n_blocks, n_pixels)."""
        return Latest(lambda _: 1, 1)

    def _chain(self, effects: Sequence[Effect]) -> tuple[Effect, ...]:
        return tuple(sorted((*self.links, *effects), key=place_of))

    @cached_property
    def _stacks(self) -> dict[str, Stack]:
        return {}

    @cached_property
    def _seen(self) -> dict[tuple[int, int], Conditions]:
        return {}

    @cached_property
    def _memory(self) -> dict[tuple[Effect, ...], list[tuple[Remembering, Floats]]]:
        return {}
