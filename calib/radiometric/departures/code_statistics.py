"""Statistics of codes as if what was rounded had had another mean and less noise.

Rounding is undone before and done again behind, for its bias follows the mean that was sampled.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.estimation.block_table import Cells
from calib.radiometric.estimation.parts import Parts
from calib.recording.block_statistics import BlockStatistics
from calib.rounding import rounded_moments, unrounded_mean


def without_shift(
    statistics: Sequence[BlockStatistics],
    shift: Cells,
    ratio: Cells,
    parts: Parts | None,
) -> tuple[BlockStatistics, ...]:
    """Return the statistics of codes without the shift; `parts` tells the noise that is rounded."""
    return tuple(
        replace(s, mean_dn=mean, variance_dn2=variance)
        for s, d, r in zip(statistics, shift, ratio, strict=True)
        for mean, variance in [_moments(s, d, r, parts)]
    )


def _moments(
    s: BlockStatistics, shift: Columns, ratio: Columns, parts: Parts | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if parts is None:
        return s.mean_dn - shift, s.variance_dn2
    estimate = parts.estimate
    signal = s.mean_dn - shift - np.nan_to_num(estimate.fit.offset)
    sigma = estimate.noise.sigma_dn(signal)
    sampled = sigma / np.sqrt(ratio)
    mean = unrounded_mean(s.mean_dn, sampled).mean_dn
    rounded, anew = rounded_moments(mean, sampled), rounded_moments(mean - shift, sigma)
    noise = s.variance_dn2 - (rounded.variance_dn2 - sampled**2)
    variance = noise * ratio + (anew.variance_dn2 - sigma**2)
    return anew.mean_dn, np.maximum(variance, 0.0)
