"""The dark level: what a cell's mean is without light and without dark charge.

The darks' means, averaged; where those of a tap grow with exposure by five standard errors, the
growth is dark current, whose charge has shot noise as light's has, and it counts as signal.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.transfer.photon_transfer.cells import BlockCells

_GROWTH_SIGMA = 5.0


@dataclass(frozen=True)
class DarkLevel:
    """What darks say.

    Attributes:
        offset_dn: At exposure 0, (n_cells,); 0 where there are no darks.
        growth_dn_per_us: Of each tap, (n_taps,); 0 where none is seen.
        is_known: Whether there are darks.
    """

    offset_dn: Columns
    growth_dn_per_us: Columns
    is_known: bool

    def signal_dn(self, block: BlockCells, tap: NDArray[np.intp]) -> Columns:
        """Return what a block's cells have above the level, DN; of a dark its tap's growth."""
        if block.block.kind == "dark":
            return np.asarray(self.growth_dn_per_us[tap] * block.block.exposure_us)
        return block.mean_dn - self.offset_dn


def dark_level(blocks: Sequence[BlockCells], tap: NDArray[np.intp], pixels: Columns) -> DarkLevel:
    """Return the dark level of every cell."""
    n_taps = int(tap.max()) + 1
    darks = [b for b in blocks if b.block.kind == "dark"]
    if not darks:
        return DarkLevel(np.zeros(len(tap)), np.zeros(n_taps), False)
    means = np.array([b.mean_dn for b in darks])
    exposure = np.array([b.block.exposure_us for b in darks])
    weights = np.array([float(max(b.n_exposures, 1)) for b in darks])
    size = np.bincount(tap, pixels, n_taps)
    by_tap = np.array([np.bincount(tap, m * pixels, n_taps) / size for m in means])
    growth = np.array([_growth(exposure, by_tap[:, t], weights) for t in range(n_taps)])
    offset = np.average(means, axis=0, weights=weights)
    offset = offset - growth[tap] * np.average(exposure, weights=weights)
    return DarkLevel(offset, growth, True)


def _growth(exposure: Columns, mean: Columns, weights: Columns) -> float:
    """Return the slope, DN per µs, where it is five times its scatter; else 0."""
    centred = exposure - np.average(exposure, weights=weights)
    spread = float((weights * centred**2).sum())
    if len(mean) < 4 or spread <= 0:
        return 0.0
    slope = float((weights * centred * mean).sum() / spread)
    rest = mean - np.average(mean, weights=weights) - slope * centred
    std = np.sqrt((weights * rest**2).sum() / (len(mean) - 2) / spread)
    return slope if slope > _GROWTH_SIGMA * std else 0.0
