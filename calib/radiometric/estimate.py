"""From block statistics to each column's line: noise, selection and fit, in turn until settled.

AgCam (Olsen et al. 2010), section 5.1, with weights, a selection rule and levels of any number.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.column_fit import fit_lines
from calib.radiometric.block_table import BlockTable, Cells, Mask
from calib.radiometric.column_check import check_columns, unchanging
from calib.radiometric.column_state import ColumnState
from calib.radiometric.dark_comparison import DarkCurrent, dark_block_noise_dn, dark_current
from calib.radiometric.joint_fit import JointFit, fit_jointly
from calib.radiometric.noise_model import NoiseModel, fit_noise_model
from calib.radiometric.radiance_table import LevelGroups
from calib.radiometric.rounding import typical_variance, unrounded_mean
from calib.radiometric.selection import collapsed, within_range

ROUNDS = 4


@dataclass(frozen=True)
class LineEstimate:
    """Every column's line and what was assumed on the way.

    Attributes:
        fit: Columns and levels; masked columns have no weight.
        noise: The photon-transfer line.
        current: The dark current that was taken off.
        dark_block_noise_dn: Common scatter of the dark blocks' means.
        reason: `ColumnState` by column.
        mean_dn: Block means with rounding's bias and the dark current taken off.
    """

    fit: JointFit
    noise: NoiseModel
    current: DarkCurrent
    dark_block_noise_dn: float
    reason: NDArray[np.uint8]
    mean_dn: Cells


def estimate_lines(
    flats: BlockTable, darks: BlockTable, groups: LevelGroups, full_scale_dn: int
) -> LineEstimate:
    """Estimate DN0, slope and relative levels.

    Raises:
        NotDeterminedError: `one-exposure`, `all-saturated`, `no-temporal-noise`,
            `no-valid-column`.
    """
    still = unchanging(flats, darks)
    use = ~flats.clipped & ~still
    start = first_levels(flats, groups, use)
    fit = fit_jointly(
        flats.mean_dn, use.astype(np.float64), flats.exposure_us, groups.of_block, start
    )
    for _ in range(ROUNDS):
        noise = _noise(flats, darks, fit, use)
        predicted = fit.predicted_dn()
        sigma = noise.sigma_dn(predicted - fit.offset)
        use = within_range(predicted, sigma, full_scale_dn) & ~still
        use &= ~collapsed(flats.variance_dn2, typical_variance(sigma), flats.n_lines)
        restored = unrounded_mean(flats.mean_dn, np.where(use, sigma, 1.0))
        block_noise = dark_block_noise_dn(darks, noise)
        current = dark_current(darks, noise, block_noise)
        mean = restored.mean_dn - np.outer(flats.exposure_us, current.dn_per_us)
        variance = restored.variance_of_one_dn2 / flats.n_lines[:, None]
        weights = np.where(use, 1.0 / (variance + restored.variance_left_dn2), 0.0)
        fit = fit_jointly(mean, weights, flats.exposure_us, groups.of_block, fit.relative_level)
    longest = current.dn_per_us * flats.exposure_us.max()
    reason = check_columns(flats, darks, fit.lines, longest, full_scale_dn)
    valid = reason == ColumnState.VALID
    if not valid.any():
        raise _none_valid(reason)
    weights = np.where(valid, weights, 0.0)
    fit = fit_jointly(mean, weights, flats.exposure_us, groups.of_block, fit.relative_level)
    return LineEstimate(fit, noise, current, block_noise, reason, mean)


def first_levels(flats: BlockTable, groups: LevelGroups, use: Mask) -> Columns:
    """Return a first guess of each group's relative level; 1 for the reference.

    The reference is the level with most distinct exposures that are not clipped everywhere, and
    among equals the one with most unclipped cells. DN0 and slope of the guess are its own.

    Raises:
        NotDeterminedError: `one-exposure` or `all-saturated`.
    """
    score = []
    for g in range(len(groups.level)):
        rows = (groups.of_block == g) & (use.sum(axis=1) > 0)
        score.append((len(np.unique(flats.exposure_us[rows])), int(use[rows].sum())))
    reference = max(range(len(score)), key=lambda g: score[g])
    if score[reference][0] < 2:
        raise _no_sweep(flats, groups)
    rows = groups.of_block == reference
    lines = fit_lines(flats.mean_dn[rows], use[rows] * 1.0, flats.exposure_us[rows])
    expected = np.outer(flats.exposure_us, lines.slope)
    above = flats.mean_dn - lines.offset
    seen = use & np.isfinite(expected) & (expected > 0)
    start = np.full(len(groups.level), np.nan)
    for g in range(len(start)):
        cells = seen & (groups.of_block == g)[:, None]
        if cells.any():
            start[g] = float(np.median(above[cells] / expected[cells]))
    start[start <= 0] = np.nan
    start[reference] = 1.0
    return start


def _noise(flats: BlockTable, darks: BlockTable, fit: JointFit, use: Mask) -> NoiseModel:
    """Fit the photon-transfer line to flats and unclipped darks together."""
    offset = fit.offset
    if not len(darks):
        return fit_noise_model(flats.mean_dn, flats.variance_dn2, flats.n_lines, offset, use)
    return fit_noise_model(
        np.vstack([flats.mean_dn, darks.mean_dn]),
        np.vstack([flats.variance_dn2, darks.variance_dn2]),
        np.concatenate([flats.n_lines, darks.n_lines]),
        offset,
        np.vstack([use, ~darks.clipped & use.any(axis=0)]),
    )


def current_variances(
    estimate: LineEstimate, exposure_us: Columns
) -> tuple[Columns, Columns, Columns]:
    """Return what the dark current's uncertainty adds to var DN0, var s and their covariance.

    An error δ of the dark current shifts the means by −δ·t, and the lines by −δ times the line
    that is fitted to t itself.
    """
    times = np.broadcast_to(exposure_us[:, None], estimate.fit.weights.shape).astype(np.float64)
    lines = fit_lines(times, estimate.fit.weights, np.nan_to_num(estimate.fit.x_us))
    variance = estimate.current.std**2
    return (
        variance * lines.offset**2,
        variance * lines.slope**2,
        variance * lines.offset * lines.slope,
    )


def _no_sweep(flats: BlockTable, groups: LevelGroups) -> NotDeterminedError:
    """Say why no level has two exposures that can be used."""
    several = any(
        len(np.unique(flats.exposure_us[groups.of_block == g])) > 1
        for g in range(len(groups.level))
    )
    if several:
        return NotDeterminedError(
            "The flats are clipped at nearly every exposure, so that no line can be laid through "
            "them: record with less light or shorter exposures.",
            code="all-saturated",
        )
    return NotDeterminedError(
        "No level was recorded at two exposures or more, so that offset and responsivity cannot "
        "be told apart: record flats of one level at several exposures.",
        code="one-exposure",
    )


def _none_valid(reason: NDArray[np.uint8]) -> NotDeterminedError:
    """Say what most columns suffer from."""
    codes, counts = np.unique(reason, return_counts=True)
    worst = ColumnState(int(codes[np.argmax(counts)])).name.lower().replace("_", " ")
    return NotDeterminedError(
        f"No column can be calibrated (most are {worst}): check light, exposures and lens cap.",
        code="no-valid-column",
    )
