"""Tones: what stands out of the spectra of a recording's blocks, by line and column frequency."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from calib.diagnosis.statistics.block_sums import PADDING, BlockSums
from calib.diagnosis.statistics.exponential_sums import log_chance
from calib.diagnosis.statistics.off_place import off_place, places_beside
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.smooth_level import smooth_level

Floats = NDArray[np.float64]

SIGNIFICANT = 15.0
"""Deviance beyond what the highest of all peaks has by chance: in four searches, of what is alike
in all columns and of what is not, once for each way in which a tone may go with the signal, chance
reaches that in 4 exp(-15 / 2) = 2 of a thousand recordings."""
MOST_PEAKS = 2
FLOOR_SAMPLES = 4096
"""White levels are told from so many samples of the spectrum, lest their errors make peaks."""
MEDIAN_STD = 1.44
"""1 / ln 2: the median of n exponential variables scatters by this / sqrt(n) of itself."""
FAR_ABOVE = 4.0
SLOW = 3
"""So many half cycles a block are no tone: slow changes have power there."""


def find_peaks(sums: Sequence[BlockSums], signal: Floats) -> tuple[Peak, ...]:
    """Return the peaks that stand out of all blocks' spectra together.

    Of a weak tone a block's power over its noise tells most where blocks count by what they have
    of it: a tone of the electronics by 1 / noise, one of the light by signal^2 / noise.

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
    noise = np.array([float(floors[b].mean()) for b in used])
    peaks: list[Peak] = []
    for tone in (np.ones(len(used)), np.maximum(signal[used], 0.0)):
        weights = tone**2 / noise
        if weights.sum() > 0:
            weights /= weights.max()
            stacked = sum(w * sums[b].power / floors[b] for w, b in zip(weights, used, strict=True))
            places = _highest(np.asarray(stacked, np.float64), weights)
            peaks += [_peak(*place, sums, used, floors) for place in places]
    best: dict[tuple[int, int], Peak] = {}
    for peak in sorted(peaks, key=lambda p: -p.deviance):
        best.setdefault(_place(peak, shape[0]), peak)
    best = dict(list(best.items())[:MOST_PEAKS])
    for peak in [p for p in best.values() if p.cycles_along == 0 and shape[1] > 1]:
        running_on = _running_on(peak, sums, used, floors)
        best.setdefault(_place(running_on, shape[0]), running_on)
    return tuple(best.values())


def _place(peak: Peak, n: int) -> tuple[int, int]:
    """Return what peaks of spectra of `n` line frequencies have in common that are one."""
    return round(peak.cycles_per_line * n / 4), peak.cycles_along


def _running_on(
    peak: Peak,
    sums: Sequence[BlockSums],
    used: Sequence[int],
    floors: dict[int, NDArray[np.float32]],
) -> Peak:
    """Return the place that tells whether a tone which lines share runs on within them.

    Of one of f cycles a line that runs on, less the lines' means, (sinc(f) sinc(1 - f))^2 of the
    power is seen at 1 - f cycles a line; of an offset of whole lines nothing.
    """
    n = len(sums[used[0]].power)
    found = _peak(-round(abs(peak.cycles_per_line) * n) % n, 1, 0.0, sums, used, floors)
    # It mirrors where the tone lies, whether or not any power is seen there.
    return replace(found, between=float(np.copysign(1.0, -peak.cycles_per_line) * peak.between))


def _floor(power: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the white level at each column frequency, (1, n): the median over line frequencies.

    That of few lines scatters: a frequency counts with those about it, if it is not far above them,
    as where pixels of a line or of a tap have noise in common.
    """
    # Frequencies lie half as far apart as lines resolve: every second one tells all.
    few = np.ascontiguousarray(power[::PADDING].T)
    own = np.median(few, axis=1, overwrite_input=True) / np.float32(np.log(2.0))
    n = few.shape[1]
    about = own.copy()
    about[1:] = uniform_filter1d(own[1:], min(FLOOR_SAMPLES // n + 1, len(own)), mode="nearest")
    about[0] = about[min(1, len(own) - 1)]
    above = own > about * (1.0 + FAR_ABOVE * MEDIAN_STD / np.sqrt(n))
    return np.asarray(np.maximum(np.where(above, own, about), np.float32(1e-9)))[None]


def _highest(stacked: Floats, weights: Floats) -> list[tuple[int, int, float]]:
    """Return the highest place of what is alike in all columns, and of what is not, if any.

    Each with the deviance by which it stands out of what the highest of as many has by chance. What
    all columns have in common is real: the second half of its spectrum repeats the first, and where
    the two meet power is no exponential variable, as in the column that turns each pixel.
    """
    level, n = stacked.copy(), len(stacked) // 2
    level[:SLOW, 0] = 0.0
    for real in (0, -1):
        level[n - SLOW + 1 : n + SLOW, real] = 0.0
    level[:SLOW, -1] = level[1 - SLOW :, -1] = 0.0
    found = []
    for first, part in ((0, level[:n, :1]), (1, level[:, 1:])):
        if part.size == 0:
            continue
        k, along = np.unravel_index(int(np.argmax(part)), part.shape)
        column = stacked[:, first + along]
        about = 0.0 if first else smooth_level(column[:n], weights, int(k), SLOW)
        level_here = max(white_level(column, weights), about, 1.0)
        height = float(part[k, along]) / level_here
        chance = log_chance(height, weights) + np.log(part.size)
        if -2.0 * chance > SIGNIFICANT:
            found.append((int(k), int(along) + first, -2.0 * chance))
    return found


def white_level(column: Floats, weights: Floats) -> float:
    """Return by how much the median of a column's stacked powers exceeds that of white noise.

    A sum of weighted exponential variables has nearly gamma's median (Wilson and Hilferty, 1931).
    """
    shape = weights.sum() ** 2 / (weights**2).sum()
    return float(np.median(column) / (weights.sum() * (1.0 - 1.0 / (9.0 * shape)) ** 3))


def _peak(  # noqa: PLR0917 - where it is, and what it is told from
    k: int,
    along: int,
    deviance: float,
    sums: Sequence[BlockSums],
    used: Sequence[int],
    floors: dict[int, NDArray[np.float32]],
) -> Peak:
    """Return the peak at a place of the spectra."""
    values, stds = np.zeros(len(sums)), np.full(len(sums), np.inf)
    for b in used:
        floor = float(floors[b][0, along])
        factor = 4.0 / (sums[b].spectrum_lines * (sums[b].mean_dn.size))
        values[b] = (float(sums[b].power[k, along]) - floor) * factor
        stds[b] = floor * factor
    n = len(sums[used[0]].power)
    cycles = float((k / n + 0.5) % 1.0 - 0.5)
    below, above = (
        sum(float(sums[b].power[place] / floors[b][0, place[1]]) - 1.0 for b in used)
        for place in places_beside(k, along, sums[used[0]].power.shape)
    )
    between = off_place(below, above) * PADDING / n
    return Peak(
        cycles, along, tuple(values), tuple(stds), deviance, between, sums[used[0]].spectrum_lines
    )
