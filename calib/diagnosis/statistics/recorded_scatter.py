"""How pooled statistics scatter where samples scatter more, or farther, than the baseline's do.

What an effect adds to the noise adds to the scatter of all that is told from it: of products of two
residuals by the variance, of variances by the fourth moment besides. A bit that sticks in one
sample of a hundred makes variances scatter by what single jumps do, not by what Gaussian noise of
that variance would.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import STRETCHES, Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.pooled import Pooled
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS

Floats = NDArray[np.float64]

WIDER = 1.2
"""Variances beyond the baseline's by this factor, or below, are those that count."""
CLEAR_SIGMA = 5.0
"""So far beyond chance a fourth cumulant has to be."""


def wider(each: BlockSums, expected: Floats, sensor: Sensor, counts: Counts) -> Floats:
    """Return by which factor the recorded variance is larger, 1 or more, (n_groups,).

    Args:
        each: What a block left behind.
        expected: Variance of the baseline, DN^2, (n_groups,).
        sensor: The sensor.
        counts: Its counts.
    """
    ratio = _moment(each.products.squares, each, sensor, counts) / np.maximum(expected, 1e-12)
    return np.where(ratio > WIDER, ratio, 1.0)


def as_recorded(
    each: BlockSums, expected: Floats, std: Pooled, sensor: Sensor, counts: Counts
) -> Pooled:
    """Return the standard deviations of a block's statistics, as its own samples scatter.

    No sample within the cut c adds more than c^8 to the eighth moment, so that this, by which
    fourth ones scatter, is c^4 times what lies beyond the Gaussian fourth moment, or less.

    Args:
        each: What the block left behind.
        expected: Variance of the baseline, DN^2, (n_groups,).
        std: Standard deviations of Gaussian noise of that variance.
        sensor: The sensor.
        counts: Its counts.
    """
    factor = wider(each, expected, sensor, counts)
    factor = factor * _narrower(each, expected, sensor, counts)
    samples = np.maximum(each.n_lines * counts.pixels, 1.0)
    variance = factor * expected
    cumulant = _moment(each.products.fourths, each, sensor, counts) - 3.0 * variance**2
    chance = CLEAR_SIGMA * np.sqrt(96.0 / samples) * variance**2
    jumps = np.where(cumulant > chance, cumulant, 0.0) / samples
    sigma = grouped(each.sigma_dn, sensor) / np.maximum(counts.pixels, 1.0)
    cut = CUT_SIGMA * sigma + 1.0
    of_tap = factor.reshape(-1, STRETCHES).mean(axis=1)
    by_group = ["rows", *(f"columns_{k + 1}" for k in range(COLUMN_LAGS))]
    by_group += [f"lines_{k + 1}" for k in range(LINE_LAGS)]
    found = {kind: values * factor.mean() for kind, values in std.of.items()}
    found |= {kind: std.of[kind] * factor for kind in by_group}
    found["common"] = std.of["common"] * of_tap
    found["variance"] = np.hypot(std.of["variance"] * factor, np.sqrt(jumps))
    found["kurtosis"] = np.hypot(
        std.of["kurtosis"] * factor**2,
        cut**2 * np.sqrt(jumps) / (3.0 * np.maximum(expected, 1e-12) ** 2),
    )
    return Pooled(found)


def _narrower(each: BlockSums, expected: Floats, sensor: Sensor, counts: Counts) -> Floats:
    """Return by which factor the recorded variance is smaller, 1 or less, (n_groups,).

    Where codes stop amid the noise little of it is left, and what lines share stands out of that.
    """
    freedom = max(each.n_lines - 1, 1)
    variance = _moment(each.products.squares, each, sensor, counts) * each.n_lines / freedom
    ratio = variance / np.maximum(expected, 1e-12)
    chance = np.sqrt(2.0 / np.maximum(freedom * counts.pixels, 1.0))
    clear = ratio < np.minimum(1.0 / WIDER, 1.0 - CLEAR_SIGMA * chance)
    return np.where(clear & (ratio > 0.0), ratio, 1.0)


def _moment(sums: Floats, each: BlockSums, sensor: Sensor, counts: Counts) -> Floats:
    """Return a moment of the residuals, (n_groups,), of its sums over the lines."""
    return np.asarray(grouped(sums, sensor) / each.n_lines / np.maximum(counts.pixels, 1.0))
