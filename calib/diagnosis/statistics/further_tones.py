"""What goes round in the lines' means beside the tones that stand out most: overtones, patterns.

A tone is one sine. A square wave has overtones, and a pattern that repeats after a few lines a tone
at each multiple of its frequency, folded. So the tones that all of a line's pixels share are fitted
to each block's line means and taken out, all together and at frequencies that all blocks have in
common; what stands out of the rest is the next one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import PADDING, BlockSums
from calib.diagnosis.statistics.exponential_sums import log_chance
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.smooth_level import smooth_level
from calib.diagnosis.statistics.tones import SIGNIFICANT, SLOW, white_level
from calib.diagnosis.statistics.whole_lines import whole_lines

Floats = NDArray[np.float64]

MOST = 6
"""So many are looked for: they hold 0.95 of the power of a square wave's overtones."""
NEAR = 2 * PADDING
"""A tone that is not quite steady has power in so many places on either side of its own."""
FEWEST_LINES = 16
GRID = np.linspace(-1.0, 1.0, 41)
"""Frequencies that are tried about a place, over the distance of two places."""
STRENGTHS = np.geomspace(1e-3, 10.0, 81)
"""Of a tone, that are tried, over the highest power of a block."""


@dataclass(frozen=True)
class FurtherTone:
    """A tone beside the others.

    Attributes:
        cycles_per_line: Its frequency, 0 to 0.5.
        power: Of each block, (n_blocks,), in units of the noise's at its frequency; 0 of a block
            that is not looked at.
        square_dn2: Its mean square, DN^2, on average over the blocks that are looked at.
        deviance: By which it stands out of what the highest of all places has by chance.
        goes_with_light: Whether it is more like a share of the signal than like a fixed amplitude.
    """

    cycles_per_line: float
    power: Floats
    square_dn2: float
    deviance: float
    goes_with_light: bool


def further_tones(
    sums: Sequence[BlockSums], sensor: Sensor, signal: Floats, peaks: Sequence[Peak]
) -> tuple[FurtherTone, ...]:
    """Return what stands out beside those of `peaks` that all pixels of a line share.

    Without such a peak nothing is looked for: none was high enough.
    """
    shared = [abs(peak.cycles_per_line) for peak in peaks if peak.cycles_along == 0]
    return tones_beside(shared, [whole_lines(each, sensor) for each in sums], signal)


def tones_beside(
    shared: Sequence[float], lines: Sequence[Floats], signal: Floats
) -> tuple[FurtherTone, ...]:
    """Return what stands out beside tones.

    Args:
        shared: Their frequencies, cycles per line.
        lines: Each block's line means, DN, (n_lines,) each; those of the commonest length count.
        signal: Mean signal of each block, DN, (n_blocks,).
    """
    lengths = [len(each) for each in lines]
    n = max(set(lengths), key=lengths.count)
    if not shared or n < FEWEST_LINES:
        return ()
    used = np.flatnonzero(np.array(lengths) == n)
    values = np.stack([each for each in lines if len(each) == n])
    taken: list[float] = []
    for frequency in shared:
        taken.append(_refined(_without(values, taken), frequency))
    found: list[FurtherTone] = []
    while len(found) < MOST:
        tone = _highest(_without(values, taken), np.maximum(signal[used], 0.0), taken)
        if tone is None:
            break
        taken.append(_refined(_without(values, taken), tone.cycles_per_line))
        power = np.zeros(len(lines))
        power[used] = tone.power
        found.append(replace(tone, cycles_per_line=taken[-1], power=power))
    return tuple(found)


def _without(values: Floats, frequencies: Sequence[float]) -> Floats:
    """Return (n_blocks, n_lines) values without their means and tones of those frequencies."""
    angle = 2.0 * np.pi * np.outer(np.arange(values.shape[1]), frequencies)
    design = np.hstack([np.ones((values.shape[1], 1)), np.cos(angle), np.sin(angle)])
    # Of a half cycle a line there is no sine.
    left, size, _ = np.linalg.svd(design, full_matrices=False)
    basis = left[:, size > 1e-6 * size[0]]
    return np.asarray(values - (values @ basis) @ basis.T)


def _refined(values: Floats, frequency: float) -> float:
    """Return the frequency near `frequency` at which all blocks together have most power."""
    n = values.shape[1]
    tried = np.clip(frequency + GRID / (PADDING * n), 0.0, 0.5)
    turns = np.exp(-2j * np.pi * np.outer(np.arange(n), tried))
    power = (np.abs(values @ turns) ** 2 / _noise(_power(values))).sum(axis=0)
    return float(tried[int(np.argmax(power))])


def _power(values: Floats) -> Floats:
    """Return the power of each block, from no cycle a line to a half, (n_blocks, n_lines)."""
    n = values.shape[1]
    return np.asarray(np.abs(fft.fft(values, PADDING * n)[:, :n]) ** 2)


def _noise(power: Floats) -> Floats:
    """Return the level of white noise of which powers have that median, (n_blocks, 1)."""
    # Frequencies lie half as far apart as lines resolve: every second one tells all.
    median = np.median(power[:, ::PADDING], axis=1, keepdims=True)
    return np.asarray(np.maximum(median / np.log(2.0), 1e-300))


def _highest(values: Floats, light: Floats, taken: Sequence[float]) -> FurtherTone | None:
    """Return the clearest tone, of a fixed amplitude or of a share of the light, if any."""
    power = _power(values)
    noise = _noise(power)
    near = [round(f * PADDING * values.shape[1]) for f in taken]
    found = []
    for size in (np.ones(len(light)), light):
        weights = size**2 / noise[:, 0]
        if weights.max() > 0:
            weights /= weights.max()
            found.append(_place(weights @ (power / noise), weights, near))
    k, level, deviance = max(found, key=lambda each: each[-1])
    if deviance < SIGNIFICANT:
        return None
    here, chance = power[:, k], level * noise[:, 0]
    lit = _misfit(here, chance, light) < _misfit(here, chance, np.ones(len(light)))
    # A sine of amplitude a has the power (a n / 2)^2.
    square = max(2.0 * float((here - chance).mean()) / values.shape[1] ** 2, 0.0)
    return FurtherTone(0.5 * k / len(power[0]), here / chance, square, deviance, lit)


def _misfit(power: Floats, chance: Floats, size: Floats) -> float:
    """Return minus twice the log likelihood of powers of a tone of that relative size.

    They are taken for exponential variables (Whittle, 1953), of the mean that noise and tone have.
    """
    if size.max() <= 0:
        return np.inf
    much = STRENGTHS * float(power.max())
    mean = chance + np.outer(much, (size / size.max()) ** 2)
    return float(2.0 * (np.log(mean) + power / mean).sum(axis=1).min())


def _place(stacked: Floats, weights: Floats, near: Sequence[int]) -> tuple[int, float, float]:
    """Return the highest place away from `near`, the level there, and how far it stands out."""
    n = len(stacked)
    free = np.ones(n, bool)
    free[:SLOW] = free[n - SLOW + 1 :] = False
    for k in near:
        free[max(k - NEAR, 0) : k + NEAR + 1] = False
    if not free.any():
        return 0, 1.0, 0.0
    k = int(np.argmax(np.where(free, stacked, -1.0)))
    level = max(white_level(stacked, weights), 1.0)
    deviance = _beyond_chance(stacked[k] / level, weights, n)
    if deviance > SIGNIFICANT:
        level = max(level, smooth_level(stacked, weights, k, SLOW))
        deviance = _beyond_chance(stacked[k] / level, weights, n)
    return k, level, deviance


def _beyond_chance(height: float, weights: Floats, places: int) -> float:
    return -2.0 * float(log_chance(float(height), weights) + np.log(places))
