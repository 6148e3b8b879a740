"""Normal numbers whose second moments are exact in a few lines: quadrature in place of chance.

Lines that stand for many need not be drawn: what counts is that noise has its mean, variance and
covariances. Each pixel's numbers have mean 0 and a sample variance of 1; neighbours, and the two
sources of noise, are orthogonal to each other line by line (Gram-Schmidt). Of several candidates
for a pixel, that one is taken that keeps a running sum of what cannot be made exact nearest to its
expectation: products with lines before, and the fourth moment, 3 for normal numbers (Owen, Monte
Carlo theory, methods and examples (2013), chapter 10, on matching moments).
"""

from functools import lru_cache

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.diagnosis.statistics.few_samples import lagged_covariance

Floats = NDArray[np.float64]

SETS = 32
"""Independent arrays; blocks and stretches of columns take turns."""
WIDTH = 128
"""Columns of one array."""
SOURCES = 2
"""Of noise that are orthogonal to each other: charge, and what reads it."""
NEIGHBOURS = 4
"""Columns to which each one is orthogonal, where there are lines enough."""
SEQUENCES, DRAWN_FOR_ONE = 64, 100
"""Of one number a line; so many are drawn to find each."""
KEPT_SAMPLES = 1 << 16
"""Arrays up to this size are kept for the next who asks."""
CANDIDATES = 6
FORGET = 0.97
"""Running sums forget by this factor a column: pooled statistics are local."""


def designed_normals(n_lines: int, sample: tuple[int, ...], which: int, source: int) -> Floats:
    """Return numbers for `n_lines` lines of one block, (n_lines, *sample).

    Args:
        n_lines: Lines, 2 or more.
        sample: Shape of a line, or of a frame.
        which: Number of the block; neighbouring ones get different numbers.
        source: 0 or 1 of those that are orthogonal to each other; others are independent.
    """
    if n_lines * np.prod(sample) <= KEPT_SAMPLES:
        return _kept(n_lines, sample, which, source)
    return _tiled(n_lines, sample, which, source)


@lru_cache(maxsize=128)
def _kept(n_lines: int, sample: tuple[int, ...], which: int, source: int) -> Floats:
    return _tiled(n_lines, sample, which, source)


def _tiled(n_lines: int, sample: tuple[int, ...], which: int, source: int) -> Floats:
    sets = _sets(n_lines)
    n_pixels = int(np.prod(sample))
    tiles = -(-n_pixels // WIDTH)
    # What two sources share is a set, whose arrays are orthogonal.
    first = 7 * which + 11 * (source // SOURCES)
    of_tile = (first + 5 * np.arange(tiles)) % SETS
    tiled = sets[of_tile, source % SOURCES]
    flat = np.moveaxis(tiled, 0, 1).reshape(n_lines, tiles * WIDTH)[:, :n_pixels]
    found = np.ascontiguousarray(flat).reshape(n_lines, *sample)
    found.flags.writeable = False
    return found


def designed_sequences(n_lines: int, which: int, n_beside: int = 1) -> Floats:
    """Return numbers for each line, (n_lines, n_beside), of exact variance and nearly white.

    Those that stand beside each other are orthogonal where there are lines enough.
    """
    return np.asarray(_sequences(n_lines, n_beside)[which % SEQUENCES])


@lru_cache(maxsize=8)
def _sequences(n_lines: int, n_beside: int) -> Floats:
    """Return those of many, (SEQUENCES, n_lines, n_beside), whose lags are nearest to white."""
    size = (SEQUENCES * DRAWN_FOR_ONE, n_lines, n_beside)
    tried = default_rng(n_lines).standard_normal(size)
    tried -= tried.mean(axis=1, keepdims=True)
    for k in range(1, n_beside if n_beside < n_lines else 1):
        for before in np.moveaxis(tried[..., :k], -1, 0):
            along = (before * tried[..., k]).sum(axis=1) / (before**2).sum(axis=1)
            tried[..., k] -= along[:, None] * before
    tried *= np.sqrt((n_lines - 1) / (tried**2).sum(axis=1, keepdims=True))
    # Lines are compared by what all of them have in common.
    whole, miss = tried.sum(axis=2), np.zeros(len(tried))
    for lag in range(1, min(4, n_lines)):
        miss += (lagged_covariance(whole, lag) + n_beside / n_lines) ** 2
    found = tried[np.argsort(miss)[:SEQUENCES]]
    found.flags.writeable = False
    return np.asarray(found)


@lru_cache(maxsize=4)
def _sets(n_lines: int) -> Floats:
    """Return all arrays, (SETS, SOURCES, n_lines, WIDTH)."""
    rng = default_rng(n_lines)
    reach = min(NEIGHBOURS, max((n_lines - 5) // SOURCES, 0))
    found = np.zeros((SETS, SOURCES, n_lines, WIDTH))
    sums = np.zeros((SETS, SOURCES, _features(found[:1, 0, :, :1], found[:1, 0, :, :0]).shape[-1]))
    for column in range(WIDTH):
        near = found[..., max(column - reach, 0) : column]
        for source in range(SOURCES):
            others = [*np.moveaxis(near, -1, 0).swapaxes(1, 2).reshape(-1, SETS, n_lines)]
            others += [found[:, k, :, column] for k in range(source if n_lines > SOURCES else 0)]
            tried = _orthogonal(rng, others, n_lines)
            before = found[:, source, :, max(column - 2, 0) : column]
            features = _features(tried, before)
            moved = FORGET * sums[:, source, None] + features
            best = np.argmin((moved**2).sum(axis=-1), axis=1)
            every = np.arange(SETS)
            found[:, source, :, column] = tried[every, :, best]
            sums[:, source] = moved[every, best]
    found.flags.writeable = False
    return found


def _orthogonal(rng: Generator, others: list[Floats], n_lines: int) -> Floats:
    """Return candidates, (SETS, n_lines, CANDIDATES), orthogonal to `others`, (SETS, n_lines)."""
    tried = rng.standard_normal((SETS, n_lines, CANDIDATES))
    for _ in range(2):
        tried -= tried.mean(axis=1, keepdims=True)
        for other in others:
            along = np.einsum("sl,slk->sk", other, tried) / (n_lines - 1)
            tried -= other[:, :, None] * along[:, None, :]
    return np.asarray(tried * np.sqrt((n_lines - 1) / (tried**2).sum(axis=1, keepdims=True)))


def _features(tried: Floats, before: Floats) -> Floats:
    """Return by how much candidates, (s, n, k), miss what is asked on average, (s, k, features)."""
    n = tried.shape[1]
    found = [(tried**4).mean(axis=1) / 3.0 - ((n - 1) / n) ** 2]
    for lag in (1, 2):
        if lag < n:
            own = (tried[:, lag:] * tried[:, :-lag]).sum(axis=1) / (n - lag)
            found.append(own + (n - 1) / n / (n - 1))
    for k in range(2):
        other = before[..., -1 - k] if k < before.shape[-1] else np.zeros(before.shape[:-1])
        found.append(np.einsum("sl,slk->sk", other[:, 1:], tried[:, :-1]) / n)
        found.append(np.einsum("sl,slk->sk", other[:, :-1], tried[:, 1:]) / n)
    return np.stack(found, axis=-1)
