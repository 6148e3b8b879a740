"""Which columns cannot be calibrated, and why.

Rules, in this order (the first that holds gives the reason):

- DEAD: no temporal noise in any block and the same code in all, not the highest.
- SATURATED: two distinct exposures do not remain below the upper end of the code range.
- NOT_FITTED: two distinct exposures do not remain for another reason.
- NEVER_LIT: the slope is below a tenth of the median slope of the 65 columns around it, or below
  five of its own standard uncertainties.
- HOT: DN0, the capped darks' mean or the dark current stands above the median of all columns by
  more than eight robust standard deviations (1.4826·MAD) and by more than 2 % of full scale
  (dark current: at the longest exposure).

A slope that is merely low or high (dust, PRNU) is what QE is there for and stays valid.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from calib.arrays import Columns
from calib.kernels.column_fit import LineFit
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.estimation.block_table import BlockTable

NEIGHBOURS = 65
LIT_SHARE = 0.1
LIT_SIGMA = 5.0
HOT_SIGMA = 8.0
HOT_SHARE = 0.02


def unchanging(flats: BlockTable, darks: BlockTable) -> NDArray[np.bool_]:
    """Return columns that sent one and the same code throughout, (n_columns,)."""
    tables = [table for table in (flats, darks) if len(table)]
    still = np.full(flats.mean_dn.shape[1], sum(len(table) for table in tables) > 1)
    for table in tables:
        varies = (table.variance_dn2 > 0) | (table.mean_dn != flats.mean_dn[0])
        still &= ~varies.any(axis=0)
    return still


def check_columns(
    flats: BlockTable,
    darks: BlockTable,
    lines: LineFit,
    dark_current_dn: Columns,
    full_scale_dn: int,
) -> NDArray[np.uint8]:
    """Return `ColumnState` of each column, (n_columns,).

    Args:
        flats: All flat blocks.
        darks: All dark blocks; may be empty.
        lines: The columns' fits, NaN where there is none.
        dark_current_dn: Dark current times the longest exposure, DN; 0 where unknown.
        full_scale_dn: The highest code.
    """
    reason = np.full(len(lines.slope), ColumnState.VALID, np.uint8)
    hot = _far_above(np.asarray(lines.offset, np.float64), full_scale_dn) | _far_above(
        dark_current_dn, full_scale_dn
    )
    if len(darks):
        hot |= _far_above(darks.mean_dn.mean(axis=0), full_scale_dn)
    reason[hot] = ColumnState.HOT
    reason[_unlit(lines)] = ColumnState.NEVER_LIT
    unfitted = ~np.isfinite(lines.slope)
    top = flats.mean_dn.max(axis=0) > 0.5 * full_scale_dn
    reason[unfitted] = ColumnState.NOT_FITTED
    reason[unfitted & top] = ColumnState.SATURATED
    reason[unchanging(flats, darks) & (flats.mean_dn[0] < full_scale_dn)] = ColumnState.DEAD
    return reason


def _far_above(values: Columns, full_scale_dn: int) -> NDArray[np.bool_]:
    """Return what stands out upwards, robustly."""
    known = values[np.isfinite(values)]
    if not known.size:
        return np.zeros(len(values), np.bool_)
    middle = float(np.median(known))
    robust = 1.4826 * float(np.median(np.abs(known - middle)))
    limit = middle + max(HOT_SIGMA * robust, HOT_SHARE * full_scale_dn)
    return np.asarray(np.isfinite(values) & (values > limit))


def _unlit(lines: LineFit) -> NDArray[np.bool_]:
    """Return columns that do not respond as their neighbours do."""
    known = np.flatnonzero(np.isfinite(lines.slope))
    unlit = np.zeros(len(lines.slope), np.bool_)
    if not known.size:
        return unlit
    slope = lines.slope[known].astype(np.float64)
    around = median_filter(slope, size=min(NEIGHBOURS, len(slope)), mode="nearest")
    weak = (slope < LIT_SHARE * around) | (slope < LIT_SIGMA * np.sqrt(lines.slope_variance[known]))
    unlit[known] = weak
    return unlit
