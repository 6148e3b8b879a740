"""Capped darks: do they agree with the lines' intercepts, and does the dark grow with exposure?

AgCam (Olsen et al. 2010), section 5.1, compares the mean of DN0 by regression with the mean of the
capped darks. A column whose DN0 is near or below 0 clips in the dark and its dark mean is too
high; such columns are left out of the difference by the same rule as in `selection`.

With m_b the dark mean of a block of exposure t_b, the dark current is the slope of m against t.
It adds to the apparent responsivity if it is not taken off (Eq. 1 has no such term).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.column_fit import fit_lines
from calib.radiometric.estimation.block_table import BlockTable, Cells
from calib.radiometric.estimation.noise_model import NoiseModel
from calib.radiometric.estimation.rounding import unrounded_mean
from calib.radiometric.estimation.selection import within_range

CURRENT_SIGMA = 5.0


@dataclass(frozen=True)
class DarkCurrent:
    """DN per µs, (n_columns,); all 0 where none is seen.

    Attributes:
        dn_per_us: The columns' dark current.
        std: Its standard uncertainty.
        mean_significance: The mean's, in standard uncertainties; NaN where not testable.
        mean_std: Standard uncertainty of the mean over columns; 0 where none is seen.
    """

    dn_per_us: Columns
    std: Columns
    mean_significance: float
    mean_std: float = 0.0

    @property
    def seen(self) -> bool:
        """True where it is taken off."""
        return bool(np.any(self.dn_per_us != 0))

    @classmethod
    def none(cls, n_columns: int, significance: float = float("nan")) -> Self:
        """Return that of a sensor where none is seen."""
        return cls(np.zeros(n_columns), np.zeros(n_columns), significance)

    def at(self, exposure_us: Columns) -> Cells:
        """Return the dark signal of blocks of these exposures, DN, (n_blocks, n_columns)."""
        return np.outer(exposure_us, self.dn_per_us)


@dataclass(frozen=True)
class DarkComparison:
    """Means over columns, DN.

    Attributes:
        capped_mean_dn: Of the capped darks with the dark current taken off, which is what they
            would be at exposure 0, over the valid columns.
        capped_raw_mean_dn: Of the capped darks as they are, over all their exposures.
        difference_dn: Capped darks less intercept, over valid columns that do not clip.
        difference_std_dn: Its standard uncertainty.
        columns: How many columns that is.
        clipping_columns: How many valid columns clip at 0 in the dark.
    """

    capped_mean_dn: float
    capped_raw_mean_dn: float
    difference_dn: float
    difference_std_dn: float
    columns: int
    clipping_columns: int

    @property
    def significance_sigma(self) -> float:
        """The difference in its standard uncertainties."""
        return self.difference_dn / self.difference_std_dn if self.difference_std_dn else 0.0


def _unclipped(
    darks: BlockTable, noise: NoiseModel, current: DarkCurrent
) -> tuple[Cells, Cells, NDArray[np.bool_]]:
    """Return the darks' means without rounding's bias, their variances, and what does not clip.

    Dark electrons have shot noise as those of light have.
    """
    sigma = noise.sigma_dn(np.maximum(current.at(darks.exposure_us), 0.0))
    restored = unrounded_mean(darks.mean_dn, sigma)
    variance = restored.variance_of_one_dn2 / darks.n_lines[:, None] + restored.variance_left_dn2
    clear = np.asarray(within_range(restored.mean_dn, sigma, 2**31).all(axis=0))
    return restored.mean_dn, variance, clear


def dark_block_noise_dn(darks: BlockTable, noise: NoiseModel, current: DarkCurrent) -> float:
    """Return by how much darks of one exposure differ as a whole from block to block, DN.

    What is left when the columns' own noise is taken off; 0 where fewer than two darks share an
    exposure. It is what the mean of a line's common noise over a block leaves behind.
    """
    if not len(darks):
        return 0.0
    mean, variance, clear = _unclipped(darks, noise, current)
    if not clear.any():
        return 0.0
    level, own = mean[:, clear].mean(axis=1), variance[:, clear].mean(axis=1) / clear.sum()
    spread, freedom = 0.0, 0
    for exposure in np.unique(darks.exposure_us):
        same = darks.exposure_us == exposure
        spread += float(((level[same] - level[same].mean()) ** 2).sum())
        freedom += int(same.sum()) - 1
    if freedom < 1:
        return 0.0
    return float(np.sqrt(max(spread / freedom - own.mean(), 0.0)))


def dark_current(
    darks: BlockTable, noise: NoiseModel, current: DarkCurrent, block_noise_dn: float
) -> DarkCurrent:
    """Fit the darks against exposure; columns that clip take the others' median.

    It counts as seen where the mean over columns is positive by `CURRENT_SIGMA`. `current` is what
    is known of it so far, for the darks' own shot noise.
    """
    n_columns = darks.mean_dn.shape[1]
    if len(np.unique(darks.exposure_us)) < 2:
        return DarkCurrent.none(n_columns)
    mean, variance, clear = _unclipped(darks, noise, current)
    if not clear.any():
        return DarkCurrent.none(n_columns)
    weights = 1.0 / np.maximum(variance, 1e-12)
    lines = fit_lines(mean, weights, darks.exposure_us)
    own = float(np.sqrt(lines.slope_variance[clear].sum())) / clear.sum()
    away = darks.exposure_us - darks.exposure_us.mean()
    shared = block_noise_dn / float(np.sqrt((away**2).sum()))
    value = float(lines.slope[clear].mean())
    mean_std = float(np.hypot(own, shared))
    significance = value / mean_std
    if significance < CURRENT_SIGMA:
        return DarkCurrent.none(n_columns, significance)
    spread = float(np.std(lines.slope[clear]))
    rates = np.where(clear, lines.slope, np.median(lines.slope[clear]))
    std = np.where(clear, np.sqrt(lines.slope_variance + shared**2), spread)
    return DarkCurrent(rates, std, significance, mean_std)


def compare_darks(
    darks: BlockTable,
    noise: NoiseModel,
    current: DarkCurrent,
    *,
    offset_dn: Columns,
    shared_offset_variance: float,
    block_noise_dn: float,
    valid: NDArray[np.bool_],
) -> DarkComparison | None:
    """Compare capped darks with intercepts; None without darks.

    Args:
        darks: The capped darks.
        noise: The photon-transfer line.
        current: The dark current.
        offset_dn: Intercepts, (n_columns,).
        shared_offset_variance: Of the intercepts' mean over columns, DN².
        block_noise_dn: From `dark_block_noise_dn`.
        valid: Which columns can be used.
    """
    if not len(darks):
        return None
    mean, variance, clear = _unclipped(darks, noise, current)
    use = clear & valid
    raw = float(darks.mean_dn[:, valid].mean())
    grown = current.at(darks.exposure_us)
    capped = raw - float(grown[:, valid].mean())
    clipping = int((valid & ~clear).sum())
    if not use.any():
        return DarkComparison(capped, raw, float("nan"), float("nan"), 0, clipping)
    level = (mean - grown)[:, use].mean(axis=0)
    noise_of_mean = variance[:, use].sum(axis=0) / len(darks) ** 2
    drift = current.std[use] * darks.exposure_us.mean()
    own = float((noise_of_mean + drift**2).sum()) / int(use.sum()) ** 2
    shared = shared_offset_variance + block_noise_dn**2 / len(darks)
    return DarkComparison(
        capped,
        raw,
        float((level - offset_dn[use]).mean()),
        float(np.sqrt(own + shared)),
        int(use.sum()),
        clipping,
    )
