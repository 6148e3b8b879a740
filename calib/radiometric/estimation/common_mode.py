"""What moves all columns of a block together: the source's unrest and offsets common to a line.

Such an error does not average out over columns. It is seen in the residuals' mean over columns,
block by block, and it enters DN0 and slope of all columns with one sign. With the relative unrest
η of the source from block to block and a common offset noise a, block b's mean is off by

    e_b = a_b + η_b·s̄·x_b,    var e_b = a² + η²(s̄·x_b)².

a is taken from the scatter of the capped darks, η from what is left over in the flats, with the
degrees of freedom that the fit left: B blocks less offset, slope and G − 1 levels. As these are
few, the variance is multiplied by ν/(ν − 2), the variance of Student's t for ν > 2, so that the
stated standard uncertainty is the standard deviation of what happens.

Source: JCGM 100:2008, 4.3 and 5.2 (correlated inputs); JCGM 101:2008, 6.4.9 (Student's t).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.estimation.joint_fit import JointFit


@dataclass(frozen=True)
class CommonMode:
    """Covariance of the errors that all columns share, for a column of the mean slope.

    Attributes:
        source_unrest: η, relative, of one block; NaN where no degree of freedom is left.
        unrest_sigma: How sure it is that η is not 0, as standard deviations of a normal number;
            NaN where η is.
        offset_noise_dn: a, DN, of one block.
        block_variance_dn2: What noise does to the mean residual of each block in use, a² included.
        freedom: Degrees of freedom from which η comes.
        mean_slope: s̄, DN per µs of reference light.
        by_source: Covariance of (DN0, s, r of all groups in use but the reference), DN, DN/µs, 1,
            from the source's unrest, which scales with the column's slope, and from the columns'
            own noise, averaged over them: what it does to the levels comes back to all columns.
        by_offset: The same from the common offset, which is one for all columns.
        groups: The group of each r in `covariance`.
    """

    source_unrest: float
    unrest_sigma: float
    offset_noise_dn: float
    block_variance_dn2: Columns
    freedom: int
    mean_slope: float
    by_source: NDArray[np.float64]
    by_offset: NDArray[np.float64]
    groups: tuple[int, ...]

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Both together, for a column of the mean slope."""
        return np.asarray(self.by_source + self.by_offset)

    def offset_variance(self, slope: Columns) -> Columns:
        """Return the variance of DN0 for columns of these slopes (DN/µs), DN²."""
        by_source = (slope / self.mean_slope) ** 2 * self.by_source[0, 0]
        return np.asarray(by_source + self.by_offset[0, 0])


def common_mode(
    fit: JointFit,
    exposure_us: Columns,
    group: NDArray[np.intp],
    offset_noise_dn: float,
    current_std_dn_per_us: float = 0.0,
) -> CommonMode:
    """Estimate what the columns share, from the residuals' means over columns.

    Args:
        fit: The joint fit.
        exposure_us: (n_blocks,).
        group: Level group of each block, (n_blocks,).
        offset_noise_dn: Scatter of the capped darks' means from block to block, DN.
        current_std_dn_per_us: Standard uncertainty of the mean dark current that was taken off,
            whose error enters all blocks in proportion to their exposure.
    """
    slope = float(np.nanmean(fit.slope))
    blocks = block_design(fit, group)
    used, design = blocks.used, blocks.design
    weight = fit.weights[used].mean(axis=1)
    estimator = np.linalg.pinv(design * np.sqrt(weight)[:, None]) * np.sqrt(weight)
    residual = mean_residual(fit, slope)[used]
    freedom = len(used) - design.shape[1]
    signal = slope * fit.x_us[used]
    own = _own_variance(fit, slope)[used]
    other = np.diag(offset_noise_dn**2 + own)
    other += current_std_dn_per_us**2 * np.outer(exposure_us[used], exposure_us[used])
    unrest2, sigma = _unrest(residual, signal, design @ estimator, other, freedom)
    few = freedom / (freedom - 2.0) if freedom > 2 else 1.0
    error = few * np.nan_to_num(unrest2) * signal**2 + own
    return CommonMode(
        source_unrest=float(np.sqrt(unrest2)),
        unrest_sigma=sigma,
        offset_noise_dn=offset_noise_dn,
        block_variance_dn2=offset_noise_dn**2 + own,
        freedom=freedom,
        mean_slope=slope,
        by_source=(estimator * error) @ estimator.T,
        by_offset=offset_noise_dn**2 * estimator @ estimator.T,
        groups=blocks.others,
    )


@dataclass(frozen=True)
class BlockDesign:
    """What offset, slope and levels can do to the mean over columns of each block.

    Attributes:
        used: Blocks in use.
        others: Their groups but the reference.
        design: (n_used, 2 + n_others), for a column of the mean slope.
    """

    used: NDArray[np.intp]
    others: tuple[int, ...]
    design: NDArray[np.float64]


def block_design(fit: JointFit, group: NDArray[np.intp]) -> BlockDesign:
    """Return the derivatives of the blocks' means to offset, slope and levels."""
    used = np.flatnonzero((fit.weights > 0).any(axis=1))
    reference = int(np.flatnonzero(fit.relative_level == 1.0)[0])
    others = tuple(g for g in sorted({int(g) for g in group[used]}) if g != reference)
    x_us = fit.x_us[used]
    signal = float(np.nanmean(fit.slope)) * x_us
    by_level = [np.where(group[used] == g, signal / fit.relative_level[g], 0.0) for g in others]
    return BlockDesign(used, others, np.column_stack([np.ones(len(used)), x_us, *by_level]))


def mean_residual(fit: JointFit, mean_slope: float) -> Columns:
    """Return each block's residual, as of the mean slope, averaged by weight, (n_blocks,)."""
    share = np.nan_to_num(fit.slope / mean_slope)
    above = np.einsum("bi,bi,i->b", fit.weights, np.nan_to_num(fit.residual_dn), share)
    below = fit.weights @ share**2
    return np.where(below > 0, above / np.where(below > 0, below, 1.0), 0.0)


def _own_variance(fit: JointFit, mean_slope: float) -> Columns:
    """Return what the columns' own noise leaves in `mean_residual`, DN², (n_blocks,)."""
    below = fit.weights @ np.nan_to_num(fit.slope / mean_slope) ** 2
    return np.where(below > 0, 1.0 / np.where(below > 0, below, 1.0), 0.0)


def _unrest(
    residual: Columns,
    signal: Columns,
    hat: NDArray[np.float64],
    other: NDArray[np.float64],
    freedom: int,
) -> tuple[float, float]:
    """Return η² and its significance.

    η² is the residuals' relative sum of squares over its expectation for η = 1, after what the
    common offset, the dark current and the columns' own noise (`other`, a covariance in DN²) bring
    into the sum is taken off. The sum is a weighted one of squared normal numbers: the chi-squared
    of the same mean and variance (Satterthwaite 1946), and its cube root as a normal number
    (Wilson and Hilferty 1931), tell how unlikely it is without unrest.
    """
    if freedom < 1:
        return float("nan"), float("nan")
    relative = (np.eye(len(residual)) - hat) / np.maximum(signal, 1e-3 * signal.max())[:, None]
    found = float(((residual / np.maximum(signal, 1e-3 * signal.max())) ** 2).sum())
    still = relative @ other @ relative.T
    by_other, spread = float(np.trace(still)), float((still**2).sum())
    unrest2 = max(found - by_other, 0.0) / max(float((relative**2 @ signal**2).sum()), 1e-30)
    if by_other <= 0:
        return unrest2, float("nan")
    width = 2.0 * spread / (9.0 * by_other**2)
    return unrest2, float((np.cbrt(found / by_other) - (1.0 - width)) / np.sqrt(width))
