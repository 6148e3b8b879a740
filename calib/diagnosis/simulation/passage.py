"""Carries a signal through links, on few lines of all blocks together.

The links get the same noise in every run, so that the difference of two runs is what an effect does
and not what chance does; what stands before the effect is run once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.diagnosis.baseline.fitted_links import (
    FittedLink,
    Light,
    PixelGain,
    PixelOffset,
    PixelReadNoise,
)
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_noise import KEPT_SAMPLES, NOISY_LINKS, ChainNoise
from calib.diagnosis.simulation.designed_noise import Prepared
from calib.diagnosis.simulation.side_by_side import carried_together
from calib.diagnosis.simulation.stack import Stack
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.remembering import LineByLine
from calib.kernels.noisy_signal import noisy_signal

Floats = NDArray[np.float64]
_UNUSED = default_rng(0)
_TO_DN = (*NOISY_LINKS, "system_gain", "offset")


@dataclass(frozen=True)
class Passage:
    """Through the links of one baseline, and effects among them.

    Attributes:
        table: The blocks' conditions.
        sensor: The sensor.
        noise: What the links draw.
    """

    table: ConditionsTable
    sensor: Sensor
    noise: ChainNoise

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
            own = left[: len(_TO_DN)]
            if exposed and tuple(x.name for x in own) == _TO_DN:
                signal, left = self._to_dn(signal, own, stack, draw), left[len(_TO_DN) :]
                continue
            signal, left = self.through(link, signal, stack, at, draw, noise), left[1:]
            if type(link).conditions_after is not Effect.conditions_after:
                at = [link.conditions_after(a) for a in at]
        return signal

    def _to_dn(self, charge: Floats, links: Sequence[Effect], stack: Stack, draw: int) -> Floats:
        """Return DN of the expected charge after the baseline's own noise, gain and offset."""
        shot, read, gain, offset = links
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
        signal = self.through(link, signal, stack, at, draw, noise)
        if signal.size <= KEPT_SAMPLES:
            self._kept[key] = exposed, signal
        return exposed, signal

    def through(  # noqa: PLR0917 - all that a link sees
        self,
        link: Effect,
        signal: Floats,
        stack: Stack,
        at: Sequence[Conditions],
        draw: int,
        noise: float,
    ) -> Floats:
        """Return the signal after one link, (n_lines, *sample), at each stretch's conditions."""
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
