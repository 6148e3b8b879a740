"""Tones: what stands out of the spectra of a recording's blocks, by line and column frequency."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import gamma

from calib.diagnosis.statistics.block_sums import PADDING, BlockSums

Floats = NDArray[np.float64]

SIGNIFICANT = 18.0
"""Deviance beyond what the highest of all peaks has by chance."""
MOST_PEAKS = 2


@dataclass(frozen=True)
class Peak:
    """A peak of the spectrum.

    Attributes:
        cycles_per_line: Its line frequency, -0.5 to 0.5.
        cycles_along: Cycles along a line's (a frame's) pixels.
        squared_amplitude_dn2: Of each block, what the spectrum's floor gives taken off.
        std_dn2: Its standard deviation.
        deviance: By which it stands out.
    """

    cycles_per_line: float
    cycles_along: int
    squared_amplitude_dn2: tuple[float, ...]
    std_dn2: tuple[float, ...]
    deviance: float

    def squared_amplitude(self, lines: Floats) -> float:
        """Return the squared amplitude of lines, (n_lines, n_pixels), at this frequency."""
        n, n_pixels = lines.shape
        along = np.exp(-2j * np.pi * self.cycles_along * np.arange(n_pixels) / n_pixels)
        down = np.exp(-2j * np.pi * self.cycles_per_line * np.arange(n))
        power = abs(down @ (lines - lines.mean()) @ along) ** 2
        return float(power * (2.0 / (n * n_pixels)) ** 2)

    def frequencies_hz(self, line_period_s: float) -> tuple[float, ...]:
        """Return what may be at work, Hz: a tone of that frequency, or of half of it, or folded."""
        f = self.cycles_per_line
        nearest = self.cycles_along + ((f - self.cycles_along + 0.5) % 1.0 - 0.5)
        if self.cycles_along > 0:
            return (nearest / line_period_s,)
        folded = (abs(f), 1.0 - abs(f), 1.0 + abs(f))
        return tuple(x / (k * line_period_s) for x in folded for k in (2.0, 1.0) if x > 0)


def find_peaks(sums: Sequence[BlockSums], signal: Floats) -> tuple[Peak, ...]:
    """Return the peaks that stand out of all blocks' spectra together.

    Args:
        sums: The blocks; those of the commonest length count.
        signal: Mean signal of each block, DN, (n_blocks,): a flicker is proportional to it.
    """
    lengths = [each.power.shape for each in sums]
    shape = max(set(lengths), key=lengths.count)
    used = [b for b, length in enumerate(lengths) if length == shape]
    if shape[0] < 16:
        return ()
    floors = {b: _floor(sums[b].power) for b in used}
    even = np.ones(len(used))
    bright = np.maximum(signal[used], 0.0) ** 2
    peaks: list[Peak] = []
    for weights in (even, bright / max(float(bright.max()), 1e-300)):
        if weights.sum() > 0:
            stacked = sum(w * sums[b].power / floors[b] for w, b in zip(weights, used, strict=True))
            peaks += _highest(np.asarray(stacked, np.float64), weights, sums, used, floors)
    best: dict[tuple[int, int], Peak] = {}
    for peak in sorted(peaks, key=lambda p: -p.deviance):
        best.setdefault((round(peak.cycles_per_line * shape[0] / 4), peak.cycles_along), peak)
    return tuple(best.values())[:MOST_PEAKS]


def _floor(power: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the white level at each column frequency, (1, n): the median over line frequencies."""
    # Frequencies lie half as far apart as lines resolve: every second one tells all.
    few = np.ascontiguousarray(power[::PADDING].T)
    median = np.median(few, axis=1, overwrite_input=True)[None] / np.float32(np.log(2.0))
    if len(power) < 64:
        median[:, 2:] = median[:, 2:].mean()
    return np.asarray(np.maximum(median, np.float32(1e-9)))


def _highest(
    stacked: Floats,
    weights: Floats,
    sums: Sequence[BlockSums],
    used: Sequence[int],
    floors: dict[int, NDArray[np.float32]],
) -> list[Peak]:
    """Return the highest peak of a weighted sum of spectra where chance does not reach it."""
    stacked = stacked.copy()
    stacked[:3, 0] = stacked[-2:, 0] = 0.0
    freedom = weights.sum() ** 2 / (weights**2).sum()
    scale = (weights**2).sum() / weights.sum()
    k, along = np.unravel_index(int(np.argmax(stacked)), stacked.shape)
    chance = float(gamma.logsf(stacked[k, along] / scale, freedom)) + np.log(stacked.size)
    if -2.0 * chance < SIGNIFICANT:
        return []
    n = stacked.shape[0]
    values, stds = np.zeros(len(sums)), np.full(len(sums), np.inf)
    for b in used:
        floor = float(floors[b][0, along])
        factor = 4.0 / (sums[b].spectrum_lines * (sums[b].mean_dn.size))
        values[b] = (float(sums[b].power[k, along]) - floor) * factor
        stds[b] = floor * factor
    cycles = float((k / n + 0.5) % 1.0 - 0.5)
    return [Peak(cycles, int(along), tuple(values), tuple(stds), -2.0 * chance)]
