"""The dark current: how the capped darks grow with exposure.

With m_b the dark mean of a block of exposure t_b, the dark current is the slope of m against t.
It adds to the apparent responsivity if it is not taken off (Eq. 1 of AgCam has no such term), and
a test that decides whether to take it off leaves what is just not significant in the slopes. It is
taken off always, with its uncertainty, wherever darks of two exposures tell it.

The mean over columns is known well, a single column's current less so: its slope is off by u_i,
while the columns truly differ by τ only. Of a column's deviation from the mean the share
k = τ²/(τ² + u_i²) is kept, which has the least mean square error and the variance k·u_i² (empirical
Bayes; Efron and Morris 1975). A column that stands out by five standard uncertainties is not of
that kind (a hot one) and keeps its own as it is. Below, what is not kept may be real where it is
more than noise: a deviation d has the variance (1 − k)²·(d² − u_i²), if that is larger.

Common to all columns are the error of the mean and that of the blocks' common offsets
(`block_noise`); columns that clip at 0 take the mean.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.column_fit import fit_lines
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.block_table import Cells
from calib.radiometric.estimation.clear_darks import ClearDarks

CURRENT_SIGMA = 5.0
"""From where on a dark current is worth a sentence, and a column's not that of the others."""


@dataclass(frozen=True)
class DarkCurrent:
    """DN per µs, (n_columns,); all 0 where it is not known.

    Attributes:
        dn_per_us: The columns' dark current.
        own_std: Standard uncertainty of a column's difference from the mean.
        mean_std: That of the mean, common to all columns; 0 where nothing is known.
        mean_significance: The mean's, in standard uncertainties; NaN where nothing is known.
        outstanding: Columns that stand out from the others, (n_columns,).
    """

    dn_per_us: Columns
    own_std: Columns
    mean_std: float
    mean_significance: float
    outstanding: NDArray[np.bool_]

    @property
    def std(self) -> Columns:
        """Standard uncertainty of `dn_per_us`, (n_columns,)."""
        return np.hypot(self.own_std, self.mean_std)

    @property
    def known(self) -> bool:
        """True where darks of two exposures tell it."""
        return bool(np.isfinite(self.mean_significance))

    def is_near(self, other: Self, share: float) -> bool:
        """Return whether no column differs by more than `share` of its standard uncertainty."""
        return not bool((np.abs(self.dn_per_us - other.dn_per_us) > share * self.std).any())

    @classmethod
    def none(cls, n_columns: int) -> Self:
        """Return that of a sensor of which nothing is known."""
        nothing = np.zeros(n_columns)
        return cls(nothing, nothing, 0.0, float("nan"), np.zeros(n_columns, np.bool_))

    def at(self, exposure_us: Columns) -> Cells:
        """Return the dark signal of blocks of these exposures, DN, (n_blocks, n_columns)."""
        return np.outer(exposure_us, self.dn_per_us)


def dark_current(darks: ClearDarks, noise: BlockNoise) -> DarkCurrent:
    """Fit the darks against exposure, and weigh each column's slope against all columns'."""
    clear, n_columns = darks.clear, len(darks.clear)
    if len(np.unique(darks.exposure_us)) < 2 or not clear.any():
        return DarkCurrent.none(n_columns)
    weights = 1.0 / np.maximum(darks.variance_dn2, 1e-12)
    lines = fit_lines(darks.mean_dn, weights, darks.exposure_us)
    slope = np.asarray(lines.slope[clear], np.float64)
    variance = np.asarray(lines.slope_variance[clear], np.float64)
    usual, spread2 = _usual(slope, variance)
    mean = float(slope[usual].mean())
    kept = np.where(usual, spread2 / (spread2 + variance), 1.0)
    rates, own_std = np.full(n_columns, mean), np.full(n_columns, np.sqrt(spread2))
    rates[clear] += kept * (slope - mean)
    left = (1.0 - kept) ** 2 * ((slope - mean) ** 2 - variance)
    own_std[clear] = np.sqrt(np.maximum(kept * variance, left))
    own_std[~clear] = max(np.sqrt(spread2), float(np.std(rates[clear])))
    shared = _of_block_noise(weights[:, clear].mean(axis=1), darks.exposure_us, noise)
    mean_std = float(np.hypot(np.sqrt(variance[usual].sum()) / usual.sum(), shared))
    outstanding = np.zeros(n_columns, np.bool_)
    outstanding[clear] = ~usual
    return DarkCurrent(rates, own_std, mean_std, mean / mean_std, outstanding)


def _usual(slope: Columns, variance: Columns) -> tuple[NDArray[np.bool_], float]:
    """Return which columns do not stand out, and by what variance τ² they differ in truth."""
    away = np.abs(slope - np.median(slope)) / np.sqrt(variance)
    robust = max(1.0, 1.4826 * float(np.median(away)))
    usual = away <= CURRENT_SIGMA * robust
    scatter = float(np.mean((slope[usual] - slope[usual].mean()) ** 2))
    return usual, max(scatter - float(variance[usual].mean()), 0.0)


def _of_block_noise(weights: Columns, exposure_us: Columns, noise: BlockNoise) -> float:
    """Return the standard uncertainty of the mean slope from the blocks' common offsets."""
    away = weights * (exposure_us - weights @ exposure_us / weights.sum())
    return float(np.sqrt(noise.variance_dn2 * (away**2).sum()) / (away @ exposure_us))
