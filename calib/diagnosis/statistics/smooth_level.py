"""The level that a spectrum has about a place, where lines wander and it is not white.

A line that keeps the share p of what the one before was off by has the spectrum 1 / (1 + p^2 - 2 p
cos(w)); the logarithm of any other that is smooth is a short sum of cosines beside (Bloomfield,
Biometrika 60, 217 (1973)). Both are fitted to all the rest of the spectrum, for what is about a
place at one end of it lies on one side alone, and lower where lines wander.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, polygamma

from calib.diagnosis.statistics.block_sums import PADDING

Floats = NDArray[np.float64]

KEPT = np.arange(0.0, 0.95, 0.1)
"""Shares that are tried of what a line may keep."""
MOST_TERMS = 2
EVERY_TERM = 8
"""Places that each number of a fit needs."""
WORTH = 4.0
"""Deviance that each has to explain."""
FAR_SIGMA = 3.0
"""By so much, at the most, another tone lifts a place."""
ROUNDS = 3


def smooth_level(column: Floats, weights: Floats, k: int, skipped: int) -> float:
    """Return the level at place `k` over what white noise has, one standard error higher.

    Args:
        column: Powers of blocks over their floors, stacked with weights, by frequency from 0 to a
            half cycle a line, (n,).
        weights: Of the blocks.
        k: The place, which does not count.
        skipped: So many of the lowest frequencies are left to what is slow.
    """
    shape = float(weights.sum() ** 2 / (weights**2).sum())
    every = np.arange(len(column))
    far = np.abs(every - k)
    # Frequencies lie half as far apart as lines resolve: every second one tells all.
    used = np.flatnonzero((far >= 2 * PADDING) & (far % PADDING == 0) & (every >= skipped))
    if len(used) < EVERY_TERM:
        return 0.0
    noise = float(polygamma(1, shape))
    level = np.log(np.maximum(column, 1e-12) / weights.sum()) - digamma(shape) + np.log(shape)
    fits = []
    for numbers, shaped, design in _laws(len(column), len(used) // EVERY_TERM - 1):
        fit, deviance = _fitted(design[used], (level - shaped)[used], noise)
        inverse = np.linalg.inv(design[used].T @ design[used])
        error = float(np.sqrt(noise * design[k] @ inverse @ design[k]))
        fits.append((deviance + WORTH * numbers, float(shaped[k] + design[k] @ fit) + error))
    return float(np.exp(min(fits)[1]))


def _laws(n: int, most: int) -> Iterator[tuple[int, Floats, Floats]]:
    """Yield how many numbers a law has beside its level, what lines keep, and cosines."""
    angle = np.pi * np.arange(n) / n
    for kept in KEPT:
        shaped = -np.log(1.0 + kept**2 - 2.0 * kept * np.cos(angle))
        for terms in range(MOST_TERMS + 1):
            numbers = terms + int(kept > 0.0)
            if numbers <= most:
                yield numbers, shaped, np.cos(np.outer(angle, np.arange(terms + 1)))


def _fitted(design: Floats, values: Floats, noise: float) -> tuple[Floats, float]:
    """Return the coefficients, and the deviance, of what is not lifted by something else."""
    most, held = FAR_SIGMA * noise**0.5, values
    for _ in range(ROUNDS):
        fit = np.linalg.lstsq(design, held, rcond=None)[0]
        off = np.clip(values - design @ fit, -most, most)
        held = design @ fit + off
    return np.asarray(fit, np.float64), float((off**2).sum()) / noise
