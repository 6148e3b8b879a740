"""By how much blocks differ as a whole: what a line's common noise leaves in a block's mean.

The darks' means over columns, m_b, are a line in exposure (a constant where all have one exposure)
plus a common offset noise a plus the columns' own, v_b. With R what takes the line off, n × n of
rank ν,

    E Σ (R m)² = ν·a² + tr(R·diag(v)·R),

of which a² follows with ν degrees of freedom: the darks less two. It is widened for these
(`excess.variance_factor`), but not beyond σ_r²/n: noise that a line's columns share is a part of
their temporal noise, and the mean of a block's n lines has its n-th part. Where no degree of
freedom is left, that bound alone is known; a anywhere from 0 to it has the variance σ_r²/3n
(rectangular; JCGM 100:2008, 4.3.7). Offsets that move more than by noise from line to line, and in
step with exposure, are not told from a dark current.
"""

from dataclasses import dataclass

import numpy as np

from calib.radiometric.estimation.clear_darks import ClearDarks
from calib.radiometric.estimation.excess import variance_factor


@dataclass(frozen=True)
class BlockNoise:
    """Common offset noise of one block.

    Attributes:
        found_dn2: a² as found; 0 where no degree of freedom is left.
        freedom: ν.
        limit_dn2: σ_r²/n, what it cannot exceed if it is noise.
    """

    found_dn2: float
    freedom: int
    limit_dn2: float

    @property
    def variance_dn2(self) -> float:
        """a² as it is to be counted."""
        if self.freedom < 1:
            return self.limit_dn2 / 3.0
        widened = variance_factor(self.freedom) * self.found_dn2
        return widened if self.found_dn2 > self.limit_dn2 else min(widened, self.limit_dn2)


def block_noise(darks: ClearDarks, limit_dn2: float) -> BlockNoise:
    """Find a from the columns that do not clip.

    Args:
        darks: The capped darks.
        limit_dn2: σ_r²/n, the temporal variance in the dark over a block's lines.
    """
    clear, times = darks.clear, darks.exposure_us
    if not clear.any():
        return BlockNoise(0.0, 0, limit_dn2)
    level = darks.mean_dn[:, clear].mean(axis=1)
    own = darks.variance_dn2[:, clear].mean(axis=1) / clear.sum()
    n_terms = min(len(np.unique(times)), 2)
    freedom = len(times) - n_terms
    if freedom < 1:
        return BlockNoise(0.0, 0, limit_dn2)
    design = np.vander(times / times.max(), n_terms)
    rest = np.eye(len(times)) - design @ np.linalg.pinv(design)
    found = (float(((rest @ level) ** 2).sum()) - float(np.diag(rest) @ own)) / freedom
    return BlockNoise(max(found, 0.0), freedom, limit_dn2)
