"""Capped darks made ready: rounding undone, columns that clip left out."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.estimation.block_table import BlockTable, Cells
from calib.radiometric.estimation.noise_model import NoiseModel
from calib.radiometric.estimation.selection import within_range
from calib.rounding import unrounded_mean


@dataclass(frozen=True)
class ClearDarks:
    """Capped darks without rounding's bias.

    Attributes:
        exposure_us: (n_blocks,).
        mean_dn: Means, (n_blocks, n_columns).
        variance_dn2: Of the means.
        clear: Columns that do not clip, by the same rule as in `selection`, (n_columns,); none
            where there is no dark.
    """

    exposure_us: Columns
    mean_dn: Cells
    variance_dn2: Cells
    clear: NDArray[np.bool_]

    @classmethod
    def of(cls, darks: BlockTable, noise: NoiseModel, dark_signal_dn: Cells) -> Self:
        """Undo the rounding; dark electrons, of which `dark_signal_dn` tells, have shot noise."""
        sigma = noise.sigma_dn(np.maximum(dark_signal_dn, 0.0))
        restored = unrounded_mean(darks.mean_dn, sigma)
        variance = restored.variance_of_one_dn2 / darks.n_lines[:, None]
        inside = within_range(restored.mean_dn, sigma, 2**31)
        return cls(
            exposure_us=darks.exposure_us,
            mean_dn=restored.mean_dn,
            variance_dn2=variance + restored.variance_left_dn2,
            clear=np.asarray(inside.all(axis=0) & (len(darks) > 0)),
        )
