"""The dark current: how the capped darks grow with exposure.

With m_b the dark mean of a block of exposure t_b, the dark current is the slope of m against t.
It adds to the apparent responsivity if it is not taken off (Eq. 1 of AgCam has no such term).
Columns that clip at 0 are left out by the same rule as in `selection`.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.column_fit import fit_lines
from calib.radiometric.estimation.block_table import BlockTable, Cells
from calib.radiometric.estimation.noise_model import NoiseModel
from calib.radiometric.estimation.selection import within_range
from calib.rounding import unrounded_mean

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

    def is_near(self, other: Self, share: float) -> bool:
        """Return whether no column differs by more than `share` of its standard uncertainty."""
        return not bool((np.abs(self.dn_per_us - other.dn_per_us) > share * self.std).any())

    @classmethod
    def none(cls, n_columns: int, significance: float = float("nan")) -> Self:
        """Return that of a sensor where none is seen."""
        return cls(np.zeros(n_columns), np.zeros(n_columns), significance)

    def at(self, exposure_us: Columns) -> Cells:
        """Return the dark signal of blocks of these exposures, DN, (n_blocks, n_columns)."""
        return np.outer(exposure_us, self.dn_per_us)


@dataclass(frozen=True)
class ClearDarks:
    """Capped darks without rounding's bias.

    Attributes:
        exposure_us: (n_blocks,).
        mean_dn: Means, (n_blocks, n_columns).
        variance_dn2: Of the means.
        clear: Columns that do not clip, (n_columns,); none where there is no dark.
    """

    exposure_us: Columns
    mean_dn: Cells
    variance_dn2: Cells
    clear: NDArray[np.bool_]

    @classmethod
    def of(cls, darks: BlockTable, noise: NoiseModel, current: DarkCurrent) -> Self:
        """Undo the rounding; dark electrons, of which `current` tells, have shot noise too."""
        sigma = noise.sigma_dn(np.maximum(current.at(darks.exposure_us), 0.0))
        restored = unrounded_mean(darks.mean_dn, sigma)
        variance = restored.variance_of_one_dn2 / darks.n_lines[:, None]
        inside = within_range(restored.mean_dn, sigma, 2**31)
        return cls(
            exposure_us=darks.exposure_us,
            mean_dn=restored.mean_dn,
            variance_dn2=variance + restored.variance_left_dn2,
            clear=np.asarray(inside.all(axis=0) & (len(darks) > 0)),
        )


def dark_block_noise_dn(darks: ClearDarks) -> float:
    """Return by how much darks of one exposure differ as a whole from block to block, DN.

    What is left when the columns' own noise is taken off; 0 where fewer than two darks share an
    exposure. It is what the mean of a line's common noise over a block leaves behind.
    """
    clear = darks.clear
    if not clear.any():
        return 0.0
    level = darks.mean_dn[:, clear].mean(axis=1)
    own = darks.variance_dn2[:, clear].mean(axis=1) / clear.sum()
    spread, freedom = 0.0, 0
    for exposure in np.unique(darks.exposure_us):
        same = darks.exposure_us == exposure
        spread += float(((level[same] - level[same].mean()) ** 2).sum())
        freedom += int(same.sum()) - 1
    if freedom < 1:
        return 0.0
    return float(np.sqrt(max(spread / freedom - own.mean(), 0.0)))


def dark_current(darks: ClearDarks, block_noise_dn: float) -> DarkCurrent:
    """Fit the darks against exposure; columns that clip take the others' median.

    It counts as seen where the mean over columns is positive by `CURRENT_SIGMA`.
    """
    clear, n_columns = darks.clear, len(darks.clear)
    if len(np.unique(darks.exposure_us)) < 2 or not clear.any():
        return DarkCurrent.none(n_columns)
    weights = 1.0 / np.maximum(darks.variance_dn2, 1e-12)
    lines = fit_lines(darks.mean_dn, weights, darks.exposure_us)
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
