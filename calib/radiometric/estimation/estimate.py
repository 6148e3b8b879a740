"""From block statistics to each column's line: noise, selection and fit, in turn until settled.

AgCam (Olsen et al. 2010), section 5.1, with weights, a selection rule and levels of any number.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.kernels.column_fit import fit_lines
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.estimation.block_noise import BlockNoise, block_noise
from calib.radiometric.estimation.block_table import BlockTable, Cells, Mask
from calib.radiometric.estimation.clear_darks import ClearDarks
from calib.radiometric.estimation.column_check import check_columns, unchanging
from calib.radiometric.estimation.dark_current import DarkCurrent, dark_current
from calib.radiometric.estimation.first_levels import first_levels, first_weights
from calib.radiometric.estimation.joint_fit import JointFit, fit_jointly
from calib.radiometric.estimation.noise_model import NoiseModel, fit_noise_model
from calib.radiometric.estimation.radiance_table import LevelGroups
from calib.radiometric.estimation.selection import collapsed, within_range
from calib.rounding import (
    NEGLIGIBLE_SIGMA_DN,
    typical_variance,
    unrounded_mean,
)

ROUNDS = 4
NEAR_SHARE = 1e-3
"""What differs by less of its standard uncertainty makes the same weights."""


@dataclass(frozen=True)
class LineEstimate:
    """Every column's line and what was assumed on the way.

    Attributes:
        fit: Columns and levels; masked columns have no weight.
        noise: The photon-transfer line.
        current: The dark current that was taken off.
        block_noise: Common offset noise of a block, from the darks.
        reason: `ColumnState` by column.
        mean_dn: Block means with rounding's bias and the dark current taken off.
    """

    fit: JointFit
    noise: NoiseModel
    current: DarkCurrent
    block_noise: BlockNoise
    reason: NDArray[np.uint8]
    mean_dn: Cells


@dataclass(frozen=True)
class _Sight:
    """What a round starts from, but for the fit before."""

    flats: BlockTable
    darks: BlockTable
    both: BlockTable
    groups: LevelGroups
    eligible: Mask
    full_scale_dn: int


@dataclass(frozen=True)
class _Round:
    """One round's result."""

    fit: JointFit
    noise: NoiseModel
    current: DarkCurrent
    block_noise: BlockNoise
    use: Mask
    mean_dn: Cells


def estimate_lines(
    flats: BlockTable, darks: BlockTable, groups: LevelGroups, full_scale_dn: int
) -> LineEstimate:
    """Estimate DN0, slope and relative levels.

    Raises:
        NotDeterminedError: `one-exposure`, `all-saturated`, `no-temporal-noise`,
            `no-valid-column`.
    """
    alive = ~unchanging(flats, darks)
    use = ~flats.clipped & alive
    start = first_levels(flats, groups, use)
    rough = np.where(use, first_weights(flats, use)[:, None], 0.0)
    fit = fit_jointly(flats.mean_dn, rough, flats.light_us, groups.of_block, start)
    sight = _Sight(flats, darks, flats.followed_by(darks), groups, alive, full_scale_dn)
    none = DarkCurrent.none(flats.mean_dn.shape[1])
    state = _improve(sight, fit, _noise(sight, fit, use), none)
    last = None
    for _ in range(ROUNDS):
        noise = _noise(sight, state.fit, state.use, state.noise)
        if last and _settled(state, last) and noise.is_near(state.noise, NEAR_SHARE):
            break
        if last:  # a cell at the limit would come and go for ever: now it may only go
            sight = replace(sight, eligible=state.use)
        last, state = state, _improve(sight, state.fit, noise, state.current)
    longest = state.current.dn_per_us * flats.exposure_us.max()
    reason = check_columns(flats, darks, state.fit.lines, longest, full_scale_dn)
    valid = reason == ColumnState.VALID
    if not valid.any():
        raise _none_valid(reason)
    fit = state.fit
    if (fit.weights[:, ~valid] > 0).any():
        weights = np.where(valid, state.fit.weights, 0.0)
        levels = state.fit.relative_level
        fit = fit_jointly(state.mean_dn, weights, flats.light_us, groups.of_block, levels)
    return LineEstimate(fit, state.noise, state.current, state.block_noise, reason, state.mean_dn)


def _settled(state: _Round, last: _Round) -> bool:
    """Return whether a round chose the cells and found the dark current of the last one."""
    same = bool((state.use == last.use).all())
    return same and state.current.is_near(last.current, NEAR_SHARE)


def _improve(sight: _Sight, fit: JointFit, noise: NoiseModel, last: DarkCurrent) -> _Round:
    """Select, weigh and fit again, with what `fit` predicts and `noise` says of it.

    What is converted is light and dark signal together: both have shot noise, and both fill the
    range of codes.
    """
    flats, groups = sight.flats, sight.groups
    darks = ClearDarks.of(sight.darks, noise, last.at(sight.darks.exposure_us))
    shared = block_noise(darks, noise.read_variance_dn2 * float(np.mean(1.0 / sight.both.n_lines)))
    current = dark_current(darks, shared)
    grown = current.at(flats.exposure_us)
    predicted = fit.predicted_dn() + (grown if last.known else 0.0)
    sigma = noise.sigma_dn(predicted - fit.offset)
    use = within_range(predicted, sigma, sight.full_scale_dn) & sight.eligible
    use &= ~collapsed(flats.variance_dn2, typical_variance(sigma), flats.n_lines)
    restored = unrounded_mean(flats.mean_dn, np.where(use, sigma, NEGLIGIBLE_SIGMA_DN))
    mean = restored.mean_dn - grown
    variance = restored.variance_of_one_dn2 / flats.n_lines[:, None]
    weights = np.where(use, 1.0 / (variance + restored.variance_left_dn2), 0.0)
    levels = fit.relative_level
    fitted = fit_jointly(mean, weights, flats.light_us, groups.of_block, levels)
    return _Round(fitted, noise, current, shared, use, mean)


def _noise(sight: _Sight, fit: JointFit, use: Mask, start: NoiseModel | None = None) -> NoiseModel:
    """Fit the photon-transfer line to flats and unclipped darks together."""
    both, darks = sight.both, ~sight.darks.clipped & use.any(axis=0)
    return fit_noise_model(
        both.mean_dn,
        both.variance_dn2,
        both.n_lines,
        fit.offset,
        np.vstack([use, darks]),
        start=start,
    )


def current_variances(
    estimate: LineEstimate, exposure_us: Columns
) -> tuple[Columns, Columns, Columns]:
    """Return what columns' own dark current adds to var DN0, var s and their covariance.

    An error δ of the dark current shifts the means by −δ·t, and the lines by −δ times the line
    that is fitted to t itself. What is common to all columns is in `common_mode`.
    """
    variance = estimate.current.own_std**2
    if not variance.any():
        return variance, variance, variance
    times = np.broadcast_to(exposure_us[:, None], estimate.fit.weights.shape).astype(np.float64)
    lines = fit_lines(times, estimate.fit.weights, np.nan_to_num(estimate.fit.x_us))
    return (
        variance * lines.offset**2,
        variance * lines.slope**2,
        variance * lines.offset * lines.slope,
    )


def _none_valid(reason: NDArray[np.uint8]) -> NotDeterminedError:
    """Say what most columns suffer from."""
    codes, counts = np.unique(reason, return_counts=True)
    worst = ColumnState(int(codes[np.argmax(counts)])).name.lower().replace("_", " ")
    return NotDeterminedError(
        f"No column can be calibrated (most are {worst}): check light, exposures and lens cap.",
        code="no-valid-column",
    )
