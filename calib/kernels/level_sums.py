"""What the columns say of each block's level, given their lines: two sums over the columns."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Cells = NDArray[np.float64]


def level_sums(
    mean_dn: Cells,
    weights: Cells,
    exposure_us: Cells,
    offset_dn: NDArray[np.floating],
    slope: NDArray[np.floating],
) -> tuple[Cells, Cells]:
    """Return Σ w·e·(mean − offset) and Σ w·e² over the columns, e = slope·exposure; (n_blocks,).

    Their ratio is the weighted least squares estimate of a level that scales e.

    Args:
        mean_dn: (n_blocks, n_columns).
        weights: As `mean_dn`; inverse variances. What has weight 0 may be NaN.
        exposure_us: (n_blocks,).
        offset_dn: (n_columns,); a column whose line is not determined, NaN, is left out.
        slope: (n_columns,), in DN per µs.
    """
    known = np.isfinite(slope) & np.isfinite(offset_dn)
    sums = np.empty((2, len(mean_dn)))
    _add(
        mean_dn,
        weights,
        exposure_us,
        np.where(known, offset_dn, 0.0),
        np.where(known, slope, 0.0),
        sums,
    )
    return sums[0], sums[1]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add(mean, weights, exposures, offset, slope, sums):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for block in range(mean.shape[0]):
        row, weight, exposure = mean[block], weights[block], exposures[block]
        above, below = 0.0, 0.0
        for i in range(mean.shape[1]):
            expected = exposure * slope[i]
            weighted = weight[i] * expected
            above += weighted * (row[i] - offset[i]) if weight[i] > 0 else 0.0
            below += weighted * expected
        sums[0, block] = above
        sums[1, block] = below
