"""What one block leaves behind, pixel by pixel and line by line."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.far_samples import FarSamples
from calib.diagnosis.statistics.rare import RareEvents
from calib.kernels.residual_products import ResidualProducts

Floats = NDArray[np.float64]

PADDING = 2
"""Frequencies lie half as far apart as the lines resolve, lest a tone fall between two."""


@dataclass(frozen=True)
class BlockSums:
    """Statistics of a block; a pixel stands at its row and column, a line sensor has one row.

    Attributes:
        n_lines: Lines, or frames.
        mean_dn: Mean code without outliers, (n_rows, n_columns).
        clipped: Share of samples at code 0 or full scale, (n_rows, n_columns).
        variance_dn2: Of all samples about their mean, outliers as well, likewise.
        products: Sums of products of residuals.
        sigma_dn: Standard deviation of each pixel's samples, held near its tap's others.
        events: What is counted: single samples that stand out, and the like.
        by_code: Samples of each tap by code, (n_taps, n_codes).
        power: Power of the residuals by line and column frequency, (2 n_lines, n_pixels // 2 + 1),
            of the first `spectrum_lines` lines, over what white noise of unit variance would give.
        spectrum_lines: How many lines that are; 0 where there is none.
        far: Single samples that lie far out, one by one.
    """

    n_lines: int
    mean_dn: Floats
    clipped: Floats
    variance_dn2: Floats
    products: ResidualProducts
    sigma_dn: Floats
    events: RareEvents
    by_code: NDArray[np.int64]
    power: NDArray[np.float32]
    spectrum_lines: int
    far: FarSamples = field(default_factory=FarSamples.none)

    @cached_property
    def histogram(self) -> NDArray[np.int64]:
        """Samples of all taps by code, (n_codes,)."""
        return np.asarray(self.by_code.sum(axis=0))

    @property
    def rare(self) -> Floats:
        """How often each of `rare.RARE` happens, (n_rare,)."""
        return self.events.counts()
