"""The radiance scale: how much certified radiance one unit of the reference level's light is.

AgCam (Olsen et al. 2010), Eq. 3 and Fig. 5: DN(i0) = L·QE(i0)·t over lamp levels at a fixed
exposure; the slope is QE at the axis. Here all columns tell how the levels compare (`joint_fit`,
r_g) and the certificate's radiances L_g are laid on them: L_g = c·r_g, c by the weighted mean of
L_g/r_g. Errors are relative: that of the certificate is common to all levels, that of each level
its own, stated or estimated from the scatter of the ratios (DerSimonian and Laird 1986).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.radiometric.estimation.common_mode import CommonMode
from calib.radiometric.estimation.common_offset import OffsetOnScale
from calib.radiometric.estimation.excess import Excess, excess, free_of, variance_factor
from calib.radiometric.estimation.radiance_table import LevelGroups


@dataclass(frozen=True)
class RadianceScale:
    """c and what it is worth.

    Attributes:
        radiance_of_reference: c, radiance where r = 1.
        level_ratio: L_g / (c·r_g) − 1 of each group, NaN where unknown: Fig. 5's residuals.
        level_ratio_std: Standard uncertainty of `level_ratio`; what all levels share is not in it.
        level_ratio_seen_std: The part of it that is the camera's: noise and the source's unrest.
        level_relative_std: What each level's radiance is uncertain by on its own.
        by_levels: Relative standard uncertainty of c from the levels' own errors.
        by_source_unrest: Relative standard uncertainty of the slopes' scale, s/c, from the source's
            unrest.
        offset_covariance_dn: Covariance of DN0 with ln(s/c) from that, for a column of the mean
            slope, DN.
        by_offset: What offsets common to all columns do to s/c.
        scatter_sigma: How far the levels scatter beyond what is stated, beyond the camera's part
            where nothing is; NaN for one level.
        freedom: How many levels of known radiance there are beyond the first.
    """

    radiance_of_reference: float
    level_ratio: Columns
    level_ratio_std: Columns
    level_ratio_seen_std: Columns
    level_relative_std: float
    by_levels: float
    by_source_unrest: float
    offset_covariance_dn: float
    by_offset: OffsetOnScale
    scatter_sigma: float
    freedom: int


def radiance_scale(
    groups: LevelGroups,
    relative_level: Columns,
    shared: CommonMode,
    level_relative_std: float | None,
    level_unrest: Columns | None = None,
) -> RadianceScale:
    """Lay the certified radiances on the relative levels.

    Args:
        groups: The levels' certified radiances.
        relative_level: r, (n_groups,).
        shared: What the columns share, the covariance of r in it.
        level_relative_std: Stated for each level's radiance; None takes it from their scatter.
        level_unrest: How far each level's mean light may be off from what is certified of it,
            relative, where the source's unrest is not in `shared` (`monitor`).

    Raises:
        NotDeterminedError: `no-radiance` where no usable level has a known radiance.
    """
    known = np.flatnonzero(groups.known & np.isfinite(relative_level) & (relative_level > 0))
    if not known.size:
        message = (
            "No flat that can be used has a known radiance, so that there is no radiance scale: "
            "give the radiance of each level, or ask for a relative calibration."
        )
        raise NotDeterminedError(message, code="no-radiance")
    ratio = groups.radiance[known] / relative_level[known]
    slope_of_level = _slope_of_levels(known, relative_level, shared)
    unrest2 = np.zeros(len(known)) if level_unrest is None else level_unrest[known] ** 2
    seen_covariance = slope_of_level @ shared.covariance @ slope_of_level.T + np.diag(unrest2)
    own = _own_of_levels(np.log(ratio), seen_covariance, level_relative_std)
    total = np.diag(seen_covariance) + own.variance
    share = 1.0 / total if (total > 0).all() else np.ones(len(known))
    share /= share.sum()
    scale = float(np.exp(share @ np.log(ratio)))
    slope_to_scale = share @ slope_of_level
    level_ratio, level_ratio_std, seen_std = np.full((3, len(relative_level)), np.nan)
    level_ratio[known] = ratio / scale - 1.0
    about_mean = np.eye(len(known)) - share
    seen_std[known] = np.sqrt(np.einsum("gi,ij,gj->g", about_mean, seen_covariance, about_mean))
    level_ratio_std[known] = np.sqrt(
        seen_std[known] ** 2 + own.variance * (about_mean**2).sum(axis=1)
    )
    widen = variance_factor(own.freedom) if level_relative_std is None else 1.0
    return RadianceScale(
        radiance_of_reference=scale,
        level_ratio=level_ratio,
        level_ratio_std=level_ratio_std,
        level_ratio_seen_std=seen_std,
        level_relative_std=float(np.sqrt(own.variance)),
        by_levels=float(np.sqrt(widen * own.variance * (share**2).sum())),
        by_source_unrest=float(
            np.sqrt(slope_to_scale @ shared.by_source @ slope_to_scale + share**2 @ unrest2)
        ),
        offset_covariance_dn=float(shared.by_source[0] @ slope_to_scale),
        by_offset=shared.offset.on_scale(slope_to_scale[2:]),
        scatter_sigma=own.sigma if own.freedom else float("nan"),
        freedom=own.freedom,
    )


def _slope_of_levels(
    known: NDArray[np.intp], relative_level: Columns, shared: CommonMode
) -> NDArray[np.float64]:
    """Return the derivatives of ln(s·r_g) to what `shared.covariance` is of, a row for each g."""
    position = {g: 2 + k for k, g in enumerate(shared.groups)}
    rows = np.zeros((len(known), 2 + len(shared.groups)))
    rows[:, 1] = 1.0 / shared.mean_slope
    for row, g in zip(rows, known.tolist(), strict=True):
        if g in position:
            row[position[g]] = 1.0 / relative_level[g]
    return rows


def _own_of_levels(
    log_ratio: Columns, covariance: NDArray[np.float64], stated: float | None
) -> Excess:
    """Return the variance of each level's own error: stated, or from the scatter of the levels."""
    variance = None if stated is None else stated**2
    if len(log_ratio) < 2:
        return Excess(variance or 0.0, float("nan"), 0)
    contrasts = free_of(np.ones((len(log_ratio), 1)))
    known = contrasts @ covariance @ contrasts.T
    return excess(contrasts @ log_ratio, known, np.eye(len(contrasts)), variance)
