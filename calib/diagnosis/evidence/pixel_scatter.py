"""By how much each pixel scatters more than its mean explains: from sample to sample, or lastingly.

Of n lines a variance v is told to 2 v^2 / (n - 1), by its squares. What lasts, of which a share r^k
is left k lines later, is told by products of lines k apart as well, each to v^2 / (n - k); about
the mean of n lines these products are -v / n without it. Weighed together, a scatter that lasts for
some ten lines, as that of a trap does that is filled and emptied, is seen nearly twice as clearly
as by squares alone.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.kernels.residual_products import LINE_LAGS

Floats = NDArray[np.float64]

LASTS = 0.8
"""Share that is taken to last to the next line. Where 0.6 or 0.95 of it does, the weights that
belong to 0.8 see 0.98 and 0.99 of what the right ones would."""
MOST_OF_A_BLOCK = 5.5
"""Standard deviations for which one block counts at the most: single samples far out raise the
variance of a block by any amount, and jumps that of most. Two blocks alone, as the only dark ones
among lit ones, in whose noise jumps are lost, come to 5.5 sqrt(2) = 7.8; one does not come to 6."""


@dataclass(frozen=True)
class PixelScatter:
    """What pixels scatter beyond what is expected.

    Attributes:
        excess: Of their variances, DN^2, (n_blocks, n_pixels).
        weight: Of these, 1 / variance, likewise.
        sigma: Standard deviations of all blocks together, as a normal number, (n_pixels,).
    """

    excess: Floats
    weight: Floats
    sigma: Floats

    def where(self, chosen: NDArray[np.bool_], other: "PixelScatter") -> "PixelScatter":
        """Return this one's pixels where they are `chosen`, (n_pixels,), else the other's."""
        return PixelScatter(
            np.where(chosen, self.excess, other.excess),
            np.where(chosen, self.weight, other.weight),
            np.where(chosen, self.sigma, other.sigma),
        )


def white_scatter(evidence: Evidence, expected: Floats) -> PixelScatter:
    """Return what squares tell.

    Args:
        evidence: Of the recording.
        expected: Variances, DN^2, (n_blocks, n_pixels).
    """
    excess, weight = _squares(evidence, expected)
    z = _as_normal(np.sqrt(weight) * excess, np.maximum(evidence.n - 1.0, 1.0)[:, None])
    return PixelScatter(excess, weight, _together(z, weight))


def lasting_scatter(evidence: Evidence, expected: Floats) -> PixelScatter:
    """Return what squares and products of lines tell together of what lasts, likewise."""
    excess, weight = _squares(evidence, expected)
    total = weight * excess
    products = np.stack([each.products.lines for each in evidence.sums])
    products = products.reshape(len(products), LINE_LAGS, -1)
    for lag in range(1, LINE_LAGS + 1):
        pairs = np.maximum(evidence.n - lag, 0.0)[:, None]
        lasting = products[:, lag - 1] + pairs * expected / evidence.n[:, None]
        total += LASTS**lag * lasting / expected**2
        weight = weight + LASTS ** (2 * lag) * pairs / expected**2
    excess = total / np.maximum(weight, 1e-300)
    second, third = _spectral_moments()
    z = _as_normal(np.sqrt(weight) * excess, evidence.n[:, None] * second**3 / third**2)
    return PixelScatter(excess, weight, _together(z, weight))


def _squares(evidence: Evidence, expected: Floats) -> tuple[Floats, Floats]:
    measured = np.stack([each.variance_dn2.ravel() for each in evidence.sums])
    weight = np.maximum(evidence.n - 1.0, 0.0)[:, None] / (2.0 * expected**2)
    return measured - expected, weight


def _together(z: Floats, weight: Floats) -> Floats:
    """Return what blocks' standard deviations tell together, (n_pixels,)."""
    held = np.minimum(z, MOST_OF_A_BLOCK)
    whole = np.sqrt(np.maximum(weight.sum(axis=0), 1e-300))
    return np.asarray((np.sqrt(weight) * held).sum(axis=0) / whole)


def _as_normal(z: Floats, freedom: Floats) -> Floats:
    """Return quadratic forms of noise as normal numbers, by Wilson and Hilferty's cube root.

    They have the skewness of chi-squared of 8 k2^3 / k3^2 degrees of freedom, k2 and k3 their
    cumulants: those of a stationary form of n lines are 2 n <s^2> and 8 n <s^3>, s its spectrum.
    """
    spread = 2.0 / (9.0 * freedom)
    ratio = np.maximum(1.0 + z * np.sqrt(2.0 / freedom), 0.0)
    return np.asarray((np.cbrt(ratio) - (1.0 - spread)) / np.sqrt(spread))


@lru_cache(maxsize=1)
def _spectral_moments() -> tuple[float, float]:
    """Return the means of s^2 and s^3 of the form's spectrum 1/2 + sum_k r^k cos(k w)."""
    w = 2.0 * np.pi * np.arange(64) / 64
    s = 0.5 + sum(LASTS**k * np.cos(k * w) for k in range(1, LINE_LAGS + 1))
    return float(np.mean(s**2)), float(np.mean(s**3))
