"""What moves all columns of a block together: the source's unrest and offsets common to a line.

Such an error does not average out over columns. It is seen in the residuals' mean over columns,
block by block, and it enters DN0 and slope of all columns with one sign. With the relative unrest
η of the source from block to block and a common offset noise a, block b's mean is off by

    e_b = a_b + η_b·s̄·x_b,    var e_b = a² + η²(s̄·x_b)².

a is taken from the scatter of the capped darks, η from what is left over in the flats, with the
degrees of freedom that the fit left: B blocks less offset, slope and G − 1 levels. As these are
few, the variance is widened (`excess`).

Source: JCGM 100:2008, 4.3 and 5.2 (correlated inputs).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.common_offset import CommonOffset, common_offset
from calib.radiometric.estimation.excess import Excess, excess, free_of, variance_factor
from calib.radiometric.estimation.joint_fit import JointFit


@dataclass(frozen=True)
class CommonMode:
    """Covariance of the errors that all columns share, for a column of the mean slope.

    Attributes:
        source_unrest: η, relative, of one block; NaN where no degree of freedom is left.
        unrest_sigma: How sure it is that η is not 0, as standard deviations of a normal number;
            NaN where η is.
        offset_noise: a, of one block.
        block_variance_dn2: What noise does to the mean residual of each block in use, a² included.
        freedom: Degrees of freedom from which η comes.
        mean_slope: s̄, DN per µs of reference light.
        by_source: Covariance of (DN0, s, r of all groups in use but the reference), DN, DN/µs, 1,
            from the source's unrest, which scales with the column's slope, and from the columns'
            own noise, averaged over them: what it does to the levels comes back to all columns.
        offset: What comes from the common offset, and from the error of the mean dark current
            that was taken off, which are as many DN in all columns.
        groups: The group of each r in `covariance`.
    """

    source_unrest: float
    unrest_sigma: float
    offset_noise: BlockNoise
    block_variance_dn2: Columns
    freedom: int
    mean_slope: float
    by_source: NDArray[np.float64]
    offset: CommonOffset
    groups: tuple[int, ...]

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Both together, for a column of the mean slope."""
        return np.asarray(self.by_source + self.offset.of_mean_column)

    def offset_variance(self, slope: Columns) -> Columns:
        """Return the variance of DN0 for columns of these slopes (DN/µs), DN²."""
        share = slope / self.mean_slope
        return np.asarray(share**2 * self.by_source[0, 0] + self.offset.offset_variance(slope))


def common_mode(
    fit: JointFit,
    exposure_us: Columns,
    group: NDArray[np.intp],
    offset_noise: BlockNoise,
    current_std_dn_per_us: float = 0.0,
) -> CommonMode:
    """Estimate what the columns share, from the residuals' means over columns.

    Args:
        fit: The joint fit.
        exposure_us: (n_blocks,).
        group: Level group of each block, (n_blocks,).
        offset_noise: Scatter of the capped darks' means from block to block.
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
    by_current = current_std_dn_per_us**2 * np.outer(exposure_us[used], exposure_us[used])
    alike = offset_noise.variance_dn2 * np.eye(len(used)) + by_current
    still = np.diag(offset_noise.found_dn2 + own) + by_current
    seen = _unrest(residual, signal, design, still) if freedom > 0 else None
    error = own + (variance_factor(freedom) * seen.variance * signal**2 if seen else 0.0)
    return CommonMode(
        source_unrest=float(np.sqrt(seen.variance)) if seen else float("nan"),
        unrest_sigma=seen.sigma if seen else float("nan"),
        offset_noise=offset_noise,
        block_variance_dn2=offset_noise.found_dn2 + own,
        freedom=freedom,
        mean_slope=slope,
        by_source=(estimator * error) @ estimator.T,
        offset=CommonOffset(common_offset(design, weight, estimator, alike), slope),
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
    design: NDArray[np.float64],
    other: NDArray[np.float64],
) -> Excess:
    """Return η² and how sure it is, beyond what is known to move the blocks (`other`, DN²)."""
    contrasts = free_of(design)
    moved = contrasts * np.maximum(signal, 1e-3 * signal.max())
    return excess(contrasts @ residual, contrasts @ other @ contrasts.T, moved @ moved.T)
