"""How far block means lie from their lines, with the error that a dark current shares among them.

A column's difference from the mean dark current is known to ± u only, and what is wrong with it
enters all flats of that column in proportion to their exposure t. (An error of the mean is taken up
by the levels.) The covariance of a column's means is therefore
W⁻¹ + u²·t·tᵀ. With r the residuals of the weighted fit and t' those of t itself, the chi-squared
of the means against that covariance is (Sherman and Morrison 1950)

    χ² = Σ w r² − (Σ w t' r)² / (1/u² + Σ w t'²),

whose expectation is the number of degrees of freedom again. At one level t is a line's abscissa,
t' is 0, and the slope takes the whole error.
"""

import numpy as np

from calib.arrays import Columns
from calib.kernels.column_fit import fit_lines
from calib.radiometric.estimation.block_table import Cells
from calib.radiometric.estimation.common_mode import CommonMode, mean_residual
from calib.radiometric.estimation.dark_current import DarkCurrent
from calib.radiometric.estimation.joint_fit import JointFit


def reduced_chi_squared(fit: JointFit, exposure_us: Columns, current: DarkCurrent) -> float:
    """Return it pooled over all columns; NaN without degrees of freedom."""
    if fit.freedom <= 0:
        return float("nan")
    return _chi_squared(fit, fit.residual_dn, exposure_us, current) / fit.freedom


def own_misfit(
    fit: JointFit, shared: CommonMode, exposure_us: Columns, current: DarkCurrent
) -> float:
    """Return the reduced chi-squared of what columns do not share; NaN if nothing is left."""
    blocks = int((fit.weights > 0).any(axis=1).sum())
    freedom = fit.freedom - (blocks - len(shared.by_source))
    if freedom <= 0:
        return float("nan")
    common = np.outer(mean_residual(fit, shared.mean_slope), fit.slope / shared.mean_slope)
    return _chi_squared(fit, fit.residual_dn - common, exposure_us, current) / freedom


def _chi_squared(
    fit: JointFit, residual_dn: Cells, exposure_us: Columns, current: DarkCurrent
) -> float:
    """Return χ² of `residual_dn`, (n_blocks, n_columns), summed over all columns."""
    plain = float(np.nansum(fit.weights * residual_dn**2))
    variance = current.own_std**2
    if not variance.any():
        return plain
    times = np.broadcast_to(exposure_us[:, None], fit.weights.shape).astype(np.float64)
    x_us = np.nan_to_num(fit.x_us)
    lines = fit_lines(times, fit.weights, x_us)
    left = times - lines.offset - np.outer(x_us, lines.slope)
    along = np.nansum(fit.weights * left * residual_dn, axis=0)
    room = np.nansum(fit.weights * left**2, axis=0)
    return plain - float(np.nansum(variance * along**2 / (1.0 + variance * room)))
