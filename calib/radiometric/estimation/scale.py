"""The radiance scale: how much certified radiance one unit of the reference level's light is.

AgCam (Olsen et al. 2010), Eq. 3 and Fig. 5: DN(i0) = L·QE(i0)·t over lamp levels at a fixed
exposure; the slope is QE at the axis. Here all columns tell how the levels compare (`joint_fit`,
r_g) and the certificate's radiances L_g are laid on them: L_g = c·r_g, c by the weighted mean of
L_g/r_g. Errors are relative: that of the certificate is common to all levels, that of each level
its own, stated or estimated from the scatter of the ratios (DerSimonian and Laird 1986).
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.radiometric.estimation.common_mode import CommonMode
from calib.radiometric.estimation.common_offset import OffsetOnScale
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
        scatter_sigma: How far the levels scatter beyond what is stated; NaN for one level.
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
    position = {g: 2 + k for k, g in enumerate(shared.groups)}
    by_level = np.zeros((len(known), len(shared.covariance)))
    for row, g in enumerate(known):
        if int(g) in position:
            by_level[row, position[int(g)]] = -1.0 / relative_level[g]
    unrest2 = np.zeros(len(known)) if level_unrest is None else level_unrest[known] ** 2
    variance = np.einsum("gi,ij,gj->g", by_level, shared.covariance, by_level) + unrest2
    excess, sigma = _excess(np.log(ratio), variance, level_relative_std)
    total = variance + excess**2
    share = 1.0 / total if (total > 0).all() else np.ones(len(known))
    share /= share.sum()
    scale = float(np.exp(share @ np.log(ratio)))
    slope_to_scale = -share @ by_level
    slope_to_scale[1] += 1.0 / shared.mean_slope
    level_ratio, level_ratio_std, seen_std = np.full((3, len(relative_level)), np.nan)
    level_ratio[known] = ratio / scale - 1.0
    about_mean = np.eye(len(known)) - share
    seen = about_mean @ by_level
    seen_std[known] = np.sqrt(
        np.einsum("gi,ij,gj->g", seen, shared.covariance, seen) + about_mean**2 @ unrest2
    )
    level_ratio_std[known] = np.hypot(
        seen_std[known], excess * np.sqrt((about_mean**2).sum(axis=1))
    )
    few = len(known) - 1
    widen = few / (few - 2.0) if level_relative_std is None and few > 2 else 1.0
    return RadianceScale(
        radiance_of_reference=scale,
        level_ratio=level_ratio,
        level_ratio_std=level_ratio_std,
        level_ratio_seen_std=seen_std,
        level_relative_std=excess,
        by_levels=float(excess * np.sqrt(widen * (share**2).sum())),
        by_source_unrest=float(
            np.sqrt(slope_to_scale @ shared.by_source @ slope_to_scale + share**2 @ unrest2)
        ),
        offset_covariance_dn=float(shared.by_source[0] @ slope_to_scale),
        by_offset=shared.offset.on_scale(slope_to_scale[2:]),
        scatter_sigma=sigma,
    )


def _excess(log_ratio: Columns, variance: Columns, stated: float | None) -> tuple[float, float]:
    """Return the levels' own standard uncertainty, and how unlikely their scatter is, in sigma."""
    freedom = len(log_ratio) - 1
    total = variance + (stated or 0.0) ** 2
    if freedom < 1 or not (total > 0).all():
        own = float(np.std(log_ratio, ddof=1)) if freedom >= 1 and stated is None else 0.0
        return (stated if stated is not None else own), float("nan")
    weight = 1.0 / total
    mean = (weight * log_ratio).sum() / weight.sum()
    chi2 = float((weight * (log_ratio - mean) ** 2).sum())
    sigma = (chi2 - freedom) / np.sqrt(2.0 * freedom)
    if stated is not None:
        return stated, float(sigma)
    below = weight.sum() - (weight**2).sum() / weight.sum()
    return float(np.sqrt(max(chi2 - freedom, 0.0) / below)), float(sigma)
