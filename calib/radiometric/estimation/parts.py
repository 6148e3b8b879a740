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


def find_parts(
    flats: BlockTable,
    darks: BlockTable,
    groups: LevelGroups,
    header: RecordingHeader,
    choices: Choices,
) -> Parts:
    """Estimate lines, profile and scale."""
    source = choices.source or SourceUncertainty.of_header(header.source)
    estimate = estimate_lines(flats, darks, groups, header.camera.full_scale_dn)
    fit = estimate.fit
    shared = common_mode(
        fit,
        flats.exposure_us,
        groups.of_block,
        estimate.dark_block_noise_dn,
        estimate.current.mean_std,
    )
    variances = _variances(estimate, flats, shared)
    profile = fit_profile(
        fit.slope, variances.slope, tap_contrasts(taps_of_camera(header.camera)), choices.order
    )
    vignette = normalise(profile, variances.slope, source.nonuniformity_relative or 0.0)
    if choices.relative:
        unit = np.where(fit.relative_level == 1.0, 1.0, np.nan)
        groups = replace(groups, radiance=unit)
    scale = radiance_scale(groups, fit.relative_level, shared, source.level_relative_std)
    chi2 = reduced_chi_squared(fit, flats.exposure_us, estimate.current)
    return Parts(estimate, chi2, shared, variances, profile, vignette, scale, source, groups)


def _variances(estimate: LineEstimate, flats: BlockTable, shared: CommonMode) -> LineVariances:
    """Return the lines' own variances: noise, inflated by what does not fit, and dark current.

    A misfit that columns do not share (a reduced chi-squared above 1) is taken for noise that the
    model lacks (Birge 1932). One factor for all columns: a column's own chi-squared has too few
    degrees of freedom to say more.
    """
    lines = estimate.fit.lines
    inflate = max(1.0, own_misfit(estimate.fit, shared, flats.exposure_us, estimate.current))
    offset, slope, covariance = current_variances(estimate, flats.exposure_us)
    return LineVariances(
        inflate * lines.offset_variance + offset,
        inflate * lines.slope_variance + slope,
        inflate * lines.covariance + covariance,
    )
