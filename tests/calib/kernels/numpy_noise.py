"""NumPy twins of the noise kernel: its own arithmetic, and the plain physics."""

from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import chi2


def splitmix64(key: int) -> int:
    mask = (1 << 64) - 1
    x = ((key ^ (key >> 30)) * 0xBF58476D1CE4E5B9) & mask
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & mask
    return x ^ (x >> 31)


def triple32(counter: NDArray[np.uint64], key: int) -> NDArray[np.uint64]:
    """The kernel's hash, in 64-bit integers cut to 32."""
    mask = np.uint64(0xFFFFFFFF)
    low, high = np.uint64(key & 0xFFFFFFFF), np.uint64(key >> 32)
    x = (counter + low) & mask
    x = ((x ^ (x >> np.uint64(17))) * np.uint64(0xED5AD4BB)) & mask
    x = (x + high) & mask
    x = ((x ^ (x >> np.uint64(11))) * np.uint64(0xAC4C1B51)) & mask
    x = ((x ^ (x >> np.uint64(15))) * np.uint64(0x31848BAB)) & mask
    return x ^ (x >> np.uint64(14))


def quantile(bits: NDArray[np.uint64]) -> NDArray[np.float64]:
    """The normal number of 32 random bits, by SciPy's own quantile function."""
    tail = ((bits & np.uint64(0x7FFFFFFF)).astype(np.float64) + 0.5) * 2.0**-32
    return np.where(bits >> np.uint64(31), ndtri(tail), -ndtri(tail))


def smooth_electrons(z: NDArray[np.float64], mean: float, read_std: float) -> NDArray[np.float64]:
    """Cornish-Fisher by skewness s and excess kurtosis k, with the third-order correction."""
    v = mean + read_std**2
    s, k = mean / v**1.5, mean / v**2
    a = s / 6 * (1 + 19 / 54 * s**2 - k / 4)
    cubic = [-a, 1 - k / 8 + 5 * s**2 / 36, a, k / 24 - s**2 / 18]
    return mean + np.sqrt(v) * polyval(z, cubic)


def physics(
    shape: tuple[int, int],
    mean: float,
    read_std: float,
    *,
    gain: float,
    offset: float,
    full_scale: int,
    full_well: float,
    rng: Generator,
) -> NDArray[np.int64]:
    """Poisson, full well, Gaussian, gain, offset, rounding and clipping, one by one."""
    electrons = np.minimum(rng.poisson(mean, shape), full_well)
    dn = (electrons + read_std * rng.standard_normal(shape)) * gain + offset
    return np.clip(np.floor(dn + 0.5), 0, full_scale).astype(np.int64)


def two_sample_p(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Chance of a chi-square as large as between two samples of codes of one distribution."""
    size = int(max(a.max(), b.max())) + 1
    counts = np.array([np.bincount(x.ravel(), minlength=size) for x in (a, b)], dtype=float)
    rare = counts.sum(0) < 40
    counts = np.hstack([counts[:, ~rare], counts[:, rare].sum(1, keepdims=True)])
    counts = counts[:, counts.sum(0) > 0]
    expected = counts.sum(0) * counts.sum(1, keepdims=True) / counts.sum()
    return float(chi2.sf(((counts - expected) ** 2 / expected).sum(), counts.shape[1] - 1))
