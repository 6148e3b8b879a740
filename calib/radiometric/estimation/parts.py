"""What a set is put together from: lines, profile and scale."""

from dataclasses import dataclass, replace

import numpy as np

from calib.forward.taps import taps_of_camera
from calib.radiometric.estimation.assemble import LineVariances
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.choices import Choices
from calib.radiometric.estimation.common_mode import CommonMode, common_mode
from calib.radiometric.estimation.estimate import LineEstimate, current_variances, estimate_lines
from calib.radiometric.estimation.misfit import own_misfit, reduced_chi_squared
from calib.radiometric.estimation.monitor import (
    MonitorCheck,
    check_monitor,
    level_unrest,
    relative_light,
    with_light,
)
from calib.radiometric.estimation.normalised_profile import Vignette, normalise
from calib.radiometric.estimation.radiance_table import LevelGroups
from calib.radiometric.estimation.scale import RadianceScale, radiance_scale
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.estimation.vignette import ProfileFit, fit_profile, tap_contrasts
from calib.recording.header import RecordingHeader


@dataclass(frozen=True)
class Parts:
    """The results on the way to a set; `groups` with the radiances that made the scale."""

    estimate: LineEstimate
    reduced_chi_squared: float
    shared: CommonMode
    variances: LineVariances
    profile: ProfileFit
    vignette: Vignette
    scale: RadianceScale
    source: SourceUncertainty
    groups: LevelGroups
    monitor: MonitorCheck


def find_parts(
    flats: BlockTable,
    darks: BlockTable,
    groups: LevelGroups,
    header: RecordingHeader,
    choices: Choices,
) -> Parts:
    """Estimate lines, profile and scale."""
    source = choices.source or SourceUncertainty.of_header(header.source)
    full_scale_dn = header.camera.full_scale_dn
    estimate, shared = _lines(flats, darks, groups, full_scale_dn)
    monitor = MonitorCheck("ignored")
    if choices.monitor == "use":
        light = relative_light(flats, groups)
        monitor = check_monitor(light, groups, estimate.fit, shared)
        if monitor.used and light is not None:
            estimate, shared = _lines(with_light(flats, light), darks, groups, full_scale_dn)
    fit = estimate.fit
    variances = _variances(estimate, flats, shared)
    profile = fit_profile(
        fit.slope, variances.slope, tap_contrasts(taps_of_camera(header.camera)), choices.order
    )
    vignette = normalise(
        profile,
        variances.slope,
        source.nonuniformity_relative or 0.0,
        shared.offset.slope_std,
    )
    if choices.relative:
        unit = np.where(fit.relative_level == 1.0, 1.0, np.nan)
        groups = replace(groups, radiance=unit)
    scale = radiance_scale(
        groups,
        fit.relative_level,
        shared,
        source.level_relative_std,
        level_unrest(monitor, groups),
    )
    chi2 = reduced_chi_squared(fit, flats.exposure_us, estimate.current)
    return Parts(
        estimate, chi2, shared, variances, profile, vignette, scale, source, groups, monitor
    )


def _lines(
    flats: BlockTable, darks: BlockTable, groups: LevelGroups, full_scale_dn: int
) -> tuple[LineEstimate, CommonMode]:
    """Return the lines and what the columns share."""
    estimate = estimate_lines(flats, darks, groups, full_scale_dn)
    shared = common_mode(
        estimate.fit,
        flats.exposure_us,
        groups.of_block,
        estimate.block_noise,
        estimate.current.mean_std,
    )
    return estimate, shared


def _variances(estimate: LineEstimate, flats: BlockTable, shared: CommonMode) -> LineVariances:
    """Return the lines' own variances: noise, inflated by what does not fit, and dark current.

    A misfit that columns do not share (a reduced chi-squared above 1) is taken for noise that the
    model lacks (Birge 1932). One factor for all columns: a column's own chi-squared has too few
    degrees of freedom to say more. Noise that a line's columns share is in the temporal variances
    as well, but columns do not have it on their own: by so much chi-squared may fall below 1.
    """
    fit, lines = estimate.fit, estimate.fit.lines
    in_common = shared.offset_noise.found_dn2 * float(fit.weights[fit.weights > 0].mean())
    own = own_misfit(fit, shared, flats.exposure_us, estimate.current)
    inflate = max(1.0 - min(in_common, 1.0), own)
    offset, slope, covariance = current_variances(estimate, flats.exposure_us)
    return LineVariances(
        inflate * lines.offset_variance + offset,
        inflate * lines.slope_variance + slope,
        inflate * lines.covariance + covariance,
    )
