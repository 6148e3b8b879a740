"""Two exposures of one scene, summed over a region of pixels."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.recording.block_statistics import BlockStatistics

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class RegionSums:
    """What the longer exposure has more than the shorter one.

    Attributes:
        n_pixels: Of the region.
        step_dn: Sum of D2 - D1, DN.
        rise_dn2: Sum of V2 - V1, DN^2.
        per_step: t1 / (t2 - t1): the shorter exposure's signal in units of the step; 1 where the
            exposure was doubled.
    """

    n_pixels: int
    step_dn: float
    rise_dn2: float
    per_step: float

    @classmethod
    def of(cls, first: BlockStatistics, second: BlockStatistics, region: Mask) -> Self:
        """Return the sums over `region`, (n_pixels,)."""
        t1, t2 = first.block.exposure_us, second.block.exposure_us
        return cls(
            n_pixels=int(region.sum()),
            step_dn=float((second.mean_dn - first.mean_dn)[region].sum()),
            rise_dn2=float((second.variance_dn2 - first.variance_dn2)[region].sum()),
            per_step=t1 / (t2 - t1),
        )

    @property
    def gain(self) -> float:
        """Pooled system gain, DN/e-."""
        return self.rise_dn2 / self.step_dn
