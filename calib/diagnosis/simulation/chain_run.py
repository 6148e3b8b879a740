"""Runs the fitted chain with and without effects, on few lines of all blocks together.

The links get the same noise in every run, so that the difference of two runs is what an effect does
and not what chance does; what stands before the effect is run once. Codes are rounded only for
effects of codes: rounding would hide small changes of a single sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.fitted_links import (
    FittedLink,
    GaussianShotNoise,
    Light,
    PixelGain,
    PixelOffset,
    PixelReadNoise,
    Response,
)
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_noise import KEPT_SAMPLES, NOISY_LINKS, ChainNoise
from calib.diagnosis.simulation.designed_noise import Prepared
from calib.diagnosis.simulation.side_by_side import carried_together
from calib.diagnosis.simulation.stack import Stack
from calib.forward.chain import without_noise
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.effects.adc import Adc
from calib.forward.effects.catalogue import place_of
from calib.forward.left import Left
from calib.forward.remembering import LineByLine, Remembering
from calib.kernels.noisy_signal import noisy_signal

Floats = NDArray[np.float64]
_UNUSED = default_rng(0)
_TO_DN = (*NOISY_LINKS, "system_gain", "offset")


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

    def about(self, baseline: Baseline) -> "FittedChain":
        """Return the chain of another baseline with the same noise."""
        return replace(self, baseline=baseline, known_noise=self.noise)

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
            (x, self.run(stack, without_noise(chain[:k]), 0, noise=0.0))
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
        return self.run(stack, links, draw, noise=0.0).reshape(stack.n_lines, -1)

    def drawn(
        self, stack: Stack, effects: Sequence[Effect], draw: int, *, coded: bool, sign: float = 1.0
    ) -> Floats:
        """Return drawn lines, (n_lines, n_rows, n_columns), whole codes where `coded`.

        With `sign` -1, the effects' own noise is the opposite one; that of the baseline is not.
        """
        links = [x for x in self._chain(effects) if coded or x.name != "adc"]
        drawn = self.run(stack, links, draw, noise=sign)
        return drawn.reshape(stack.n_lines, self.sensor.n_rows, self.sensor.n_columns)

    def has_events(self, effect: Effect) -> bool:
        """Return whether chance has a part in an effect: noise that moments do not tell."""
        return self.noise.has_events(effect)

    def has_noise(self, effect: Effect) -> bool:
        """Return whether an effect adds noise of its own that moments tell."""
        return self.noise.has_noise(effect)

    def _chain(self, effects: Sequence[Effect]) -> tuple[Effect, ...]:
        return tuple(sorted((*self.links, *effects), key=place_of))

    def run(self, stack: Stack, links: Sequence[Effect], draw: int, *, noise: float) -> Floats:
        """Return the signal after `links`, (n_lines, *sample)."""
        known = 0
        while known < len(links) and isinstance(links[known], FittedLink):
            known += 1
        exposed, signal = self._before(stack, tuple(links[:known]), draw, noise)
        at, left = list(stack.at), list(links[known:])
        while left:
            link = left[0]
            if not exposed and link.stage > Stage.SOURCE:
                signal = signal * stack.by_line([a.exposure_us for a in at], signal.ndim)
                exposed = True
            if exposed and tuple(x.name for x in left[: len(_TO_DN)]) == _TO_DN:
                signal, left = self._to_dn(signal, stack, draw), left[len(_TO_DN) :]
                continue
            signal, left = self._through(link, signal, stack, at, draw, noise), left[1:]
            if type(link).conditions_after is not Effect.conditions_after:
                at = [link.conditions_after(a) for a in at]
        return signal

    def _to_dn(self, charge: Floats, stack: Stack, draw: int) -> Floats:
        """Return DN of the expected charge after the baseline's own noise, gain and offset."""
        shot, read, gain, offset = self.links[2:6]
        assert isinstance(read, PixelReadNoise)  # noqa: S101 - so the links are made
        assert isinstance(gain, PixelGain)  # noqa: S101
        assert isinstance(offset, PixelOffset)  # noqa: S101
        one, other = (self.noise.normals(stack, link, draw) for link in (shot, read))
        return noisy_signal(charge, one, other, read.std_e, gain.dn_per_e, offset.dn)

    def _before(
        self, stack: Stack, links: tuple[Effect, ...], draw: int, noise: float
    ) -> tuple[bool, Floats]:
        """Return whether light has been exposed and the signal after links of the baseline."""
        if not links:
            scenes = [self.table.beyond_lamps(b, self.sensor.sample) for b in stack.blocks]
            counts = [a.n_lines for a in stack.at]
            return False, np.repeat(np.stack(scenes), counts, axis=0)
        key = (stack.key, tuple(x.name for x in links), draw)
        if key in self._kept:
            return self._kept[key]
        exposed, signal = self._before(stack, links[:-1], draw, noise)
        link, at = links[-1], list(stack.at)
        if not exposed and link.stage > Stage.SOURCE:
            signal = signal * stack.by_line([a.exposure_us for a in at], signal.ndim)
            exposed = True
        signal = self._through(link, signal, stack, at, draw, noise)
        if signal.size <= KEPT_SAMPLES:
            self._kept[key] = exposed, signal
        return exposed, signal

    def _through(  # noqa: PLR0917 - all that a link sees
        self,
        link: Effect,
        signal: Floats,
        stack: Stack,
        at: Sequence[Conditions],
        draw: int,
        noise: float,
    ) -> Floats:
        if isinstance(link, Light):
            light = [link.seen(a) for a in at]
            return np.asarray(signal + stack.by_line(light, signal.ndim))
        if isinstance(link, FittedLink):
            rng = Prepared(self.noise.normals(stack, link, draw)) if link.stochastic else _UNUSED
            return np.asarray(link.apply(signal, at[0], rng), np.float64)
        if link.by_signal:
            rng = self._rng(link, stack.blocks, draw, signal.shape, noise)
            return np.asarray(link.apply(signal, at[0], rng), np.float64)
        if isinstance(link, LineByLine) and link.stochastic:
            each = [
                self.noise.of_effect(link, (b,), draw, signal[where].shape, noise)
                for b, where in zip(stack.blocks, stack.parts, strict=True)
            ]
            return carried_together(link, signal, stack.parts, at, each, noise=noise)
        after = np.empty_like(signal)
        for b, where, a in zip(stack.blocks, stack.parts, at, strict=True):
            rng = self._rng(link, (b,), draw, signal[where].shape, noise)
            after[where] = link.apply(signal[where], a, rng)
        return after

    def _rng(
        self,
        link: Effect,
        blocks: Sequence[int],
        draw: int,
        shape: tuple[int, ...],
        noise: float,
    ) -> Generator:
        if not link.stochastic:
            return _UNUSED
        return self.noise.of_effect(link, blocks, draw, shape, noise)

    @cached_property
    def _kept(self) -> dict[tuple[str, tuple[str, ...], int], tuple[bool, Floats]]:
        return {}

    @cached_property
    def _stacks(self) -> dict[str, Stack]:
        return {}

    @cached_property
    def _seen(self) -> dict[tuple[int, int], Conditions]:
        return {}

    @cached_property
    def _memory(self) -> dict[tuple[Effect, ...], list[tuple[Remembering, Floats]]]:
        return {}
