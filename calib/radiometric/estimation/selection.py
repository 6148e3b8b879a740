"""Which block means may enter a column's fit: those that no end of the code range has bent.

A cell (one block, one column) is left out where the *predicted* mean lies within `CLIP_SIGMA`
standard deviations of the single sample from an end, so that a share of its samples clips. The
rule looks at the prediction of the column's line and the noise model, never at how the cell's
mean happened to fall: leaving out what fell high by chance would bend the line itself. At four
sigma the bias that is left is 7e-6 sigma, below 1 % of a mean's uncertainty up to 2 million lines.

Charge that fills the well before the converter's end clips without reaching a code's end, but
its noise collapses. A cell is left out too where its variance is far too small for its signal;
the mean and the variance of a normal sample are independent, so this does not bend the line.
"""

import numpy as np

from calib.arrays import Columns
from calib.radiometric.estimation.block_table import Cells, Mask

CLIP_SIGMA = 4.0
COLLAPSE_SIGMA = 6.0
"""A variance this many of its standard deviations too small, and below half, is collapsed."""


def within_range(predicted_dn: Cells, sigma_dn: Cells, full_scale_dn: int) -> Mask:
    """Return where practically no sample clips, (n_blocks, n_columns); NaN is not within."""
    room_below = predicted_dn + 0.5 >= CLIP_SIGMA * sigma_dn
    room_above = full_scale_dn + 0.5 - predicted_dn >= CLIP_SIGMA * sigma_dn
    return np.isfinite(predicted_dn) & room_below & room_above


def collapsed(variance_dn2: Cells, expected_dn2: Cells, n_lines: Columns) -> Mask:
    """Return where the temporal variance is far below what the signal's shot noise asks for.

    Blocks with too few lines to tell (fewer than 147) are never called collapsed.
    """
    spread = np.sqrt(2.0 / np.maximum(n_lines - 1.0, 1.0))[:, None]
    bound = np.minimum(1.0 - COLLAPSE_SIGMA * spread, 0.5)
    return np.isfinite(variance_dn2) & (variance_dn2 < bound * expected_dn2) & (bound > 0.3)
