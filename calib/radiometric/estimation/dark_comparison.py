"""Capped darks: do they agree with the lines' intercepts?

AgCam (Olsen et al. 2010), section 5.1, compares the mean of DN0 by regression with the mean of the
capped darks. A column whose DN0 is near or below 0 clips in the dark and its dark mean is too
high; such columns are left out of the difference by the same rule as in `selection`.

With the dark current taken off, the mean over n darks of mean exposure t̄ is their line's value at
exposure 0. It errs by the mean's own error and by t̄ times that of the mean dark current. What the
blocks' common offset noise a does to both, a²(1/n + t̄²/S_tt), is common to all columns and does not
average out over them. (What the dark current's error does to the intercepts is next to nothing:
slopes and levels take it.)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.clear_darks import ClearDarks
from calib.radiometric.estimation.dark_current import DarkCurrent
from calib.radiometric.estimation.noise_model import NoiseModel


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


def compare_darks(
    darks: BlockTable,
    noise: NoiseModel,
    current: DarkCurrent,
    *,
    offset_dn: Columns,
    shared_offset_variance: float,
    block_noise: BlockNoise,
    valid: NDArray[np.bool_],
) -> DarkComparison | None:
    """Compare capped darks with intercepts; None without darks.

    Args:
        darks: The capped darks.
        noise: The photon-transfer line.
        current: The dark current.
        offset_dn: Intercepts, (n_columns,).
        shared_offset_variance: Of the intercepts' mean over columns, DN².
        block_noise: Of the darks.
        valid: Which columns can be used.
    """
    if not len(darks):
        return None
    grown = current.at(darks.exposure_us)
    known = ClearDarks.of(darks, noise, grown)
    use = known.clear & valid
    raw = float(darks.mean_dn[:, valid].mean())
    capped = raw - float(grown[:, valid].mean())
    clipping = int((valid & ~known.clear).sum())
    if not use.any():
        return DarkComparison(capped, raw, float("nan"), float("nan"), 0, clipping)
    level = (known.mean_dn - grown)[:, use].mean(axis=0)
    noise_of_mean = known.variance_dn2[:, use].sum(axis=0) / len(darks) ** 2
    own = float(noise_of_mean.sum()) / int(use.sum()) ** 2
    extrapolated = float(current.mean_std * darks.exposure_us.mean()) ** 2
    shared = shared_offset_variance + block_noise.variance_dn2 / len(darks) + extrapolated
    return DarkComparison(
        capped,
        raw,
        float((level - offset_dn[use]).mean()),
        float(np.sqrt(own + shared)),
        int(use.sum()),
        clipping,
    )
