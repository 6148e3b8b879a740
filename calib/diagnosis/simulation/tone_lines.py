"""Noise-free lines of tones: what they add to second moments, and to the spectrum's peaks.

A few lines from the middle of a block hold a phase of the tone by chance, and a slow one not for a
period. So a tone is worked out on all lines of a block, or as many as are not too many, without
noise, at two phases a quarter apart: the mean of both is what it adds at any.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.mean_change import scatter_change
from calib.diagnosis.simulation.sampled_lines import SampledLines, is_tone
from calib.diagnosis.simulation.with_values import with_values
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.forward.effect import Effect

Floats = NDArray[np.float64]

FEWEST_LINES = 48
SAMPLES = 20_000
"""So many samples of a block tell a tone, or all of its lines, and never less than those lines."""


@dataclass(frozen=True)
class ToneLines:
    """Lines with tones, at two phases.

    Attributes:
        phases: What the tones add to each line, DN, of each block, at each phase.
    """

    phases: tuple[tuple[Floats, ...], ...]

    @classmethod
    def of(cls, chain: FittedChain, effects: Sequence[Effect]) -> "ToneLines":
        """Return the lines with those of `effects` that are tones; none where none is."""
        tonal = [effect for effect in effects if is_tone(effect)]
        if not tonal:
            return cls(())
        most = max(FEWEST_LINES, SAMPLES // chain.sensor.n_pixels)
        n = [min(int(lines), most) for lines in chain.table.n_lines]
        stack = chain.stack([(b, np.arange(float(k))) for b, k in enumerate(n)], "tone")
        found = []
        for turned in (tonal, [_a_quarter_on(effect) for effect in tonal]):
            lines = chain.noise_free(stack, turned, 0)
            found.append(
                tuple(
                    lines[where] - chain.baseline.mean_dn[b].ravel()
                    for b, where in enumerate(stack.parts)
                )
            )
        return cls(tuple(found))

    def at_peaks(self, peaks: Sequence[Peak], n_blocks: int) -> Floats:
        """Return squared amplitudes at the peaks, DN^2, (n_blocks, n_peaks)."""
        found = np.zeros((n_blocks, len(peaks)))
        for blocks in self.phases:
            centred = [each - each.mean() for each in blocks]
            squares = [[_squared(peak, each) for peak in peaks] for each in centred]
            found += np.array(squares).reshape(found.shape) / len(self.phases)
        return found

    def scatter(
        self, variance: Floats, sensor: Sensor, counts: Counts
    ) -> tuple[Floats, Floats] | None:
        """Return changes of pooled statistics and of what is counted, as `scatter_change` does."""
        if not self.phases:
            return None
        every = [
            scatter_change([_sampled(each) for each in blocks], variance, sensor, counts)
            for blocks in self.phases
        ]
        moved, rare = (np.mean(parts, axis=0) for parts in zip(*every, strict=True))
        return moved, rare

    def pixel_ratio(self, variance: Floats) -> Floats:
        """Return the variance of each pixel over that of its noise, (n_blocks, n_pixels)."""
        ratio = np.zeros((len(variance), variance[0].size))
        for blocks in self.phases:
            for b, lines in enumerate(blocks):
                ratio[b] += lines.var(axis=0) / variance[b].ravel() / len(self.phases)
        return ratio


def _squared(peak: Peak, lines: Floats) -> float:
    """Return the squared amplitude at a peak, as all lines of a spectrum tell it.

    Of few lines a tone has more of its power at a frequency beside its own.
    """
    seen = peak.share_seen(peak.n_lines) / peak.share_seen(len(lines))
    return peak.squared_amplitude(lines) * seen


def _a_quarter_on(effect: Effect) -> Effect:
    phase_rad = float(getattr(effect, "phase_rad"))  # noqa: B009 - every tone has one
    return with_values(effect, {"phase_rad": phase_rad + (-pi / 2 if phase_rad > 0 else pi / 2)})


def _sampled(lines: Floats) -> SampledLines:
    n = len(lines)
    first = np.eye(n)[:ONSET_LINES]
    return SampledLines(lines, np.full(n, 1.0 / n), first, np.eye(n))
