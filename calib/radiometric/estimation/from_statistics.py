"""The calibration itself: block statistics in, a coefficient set out."""

from dataclasses import dataclass, replace

import numpy as np

from calib.radiometric.calibration import CalibrationFigures
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.coefficients.column_state import ColumnState
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.assemble import coefficient_columns, scale_relative_std
from calib.radiometric.estimation.block_table import BlockTable
from calib.radiometric.estimation.choices import Choices, check_radiance, check_recording, no_flats
from calib.radiometric.estimation.dark_comparison import DarkComparison, compare_darks
from calib.radiometric.estimation.domain import domain_of
from calib.radiometric.estimation.findings import (
    dark_findings,
    line_findings,
    set_findings,
    source_findings,
)
from calib.radiometric.estimation.parts import Parts, find_parts
from calib.radiometric.estimation.radiance_table import group_levels
from calib.radiometric.estimation.responsivity_budget import responsivity_budget
from calib.radiometric.estimation.sensor_noise import SensorNoise, sensor_noise
from calib.recording.block_statistics import RecordingStatistics
from calib.recording.header import RecordingHeader


@dataclass(frozen=True)
class Determined:
    """A set and its examination, but for the held-out lines."""

    coefficients: CoefficientSet
    darks: DarkComparison | None
    figures: CalibrationFigures
    warnings: tuple[str, ...]


def determine(
    statistics: RecordingStatistics,
    header: RecordingHeader,
    provenance: Provenance,
    choices: Choices | None = None,
) -> Determined:
    """Determine DN0, VE, QE and the radiance scale.

    Raises:
        InputError: `area-sensor`, `bad-radiance`, `bad-order`, `bad-source-uncertainty`,
            `bad-monitor`.
        NotDeterminedError: `no-flats`, `missing-darks`, `one-exposure`, `all-saturated`,
            `no-temporal-noise`, `no-valid-column`, `too-few-columns`, `no-radiance`.
    """
    choices = choices or Choices()
    check_recording(header, choices)
    flats = BlockTable.of_kind(statistics.fit, "flat")
    darks = BlockTable.of_kind(statistics.fit, "dark")
    if not len(flats):
        raise no_flats()
    groups = group_levels(flats.blocks, choices.radiances)
    check_radiance(groups, choices)
    parts = find_parts(flats, darks, groups, header, choices)
    noise = sensor_noise(statistics, header.camera, parts.estimate.noise)
    told = {**provenance.parameters, **noise.provenance}
    provenance = replace(provenance, parameters=told)
    coefficients = _assemble(
        parts, flats, darks, header, provenance, noise=noise, relative=choices.relative
    )
    comparison = _compare(parts, darks, coefficients)
    warnings = (
        *source_findings(parts.source, parts.scale, choices.relative),
        *line_findings(parts),
        *noise.warnings,
        *dark_findings(comparison),
        *set_findings(coefficients, choices.relative),
    )
    return Determined(coefficients, comparison, _figures(parts), warnings)


def _assemble(
    parts: Parts,
    flats: BlockTable,
    darks: BlockTable,
    header: RecordingHeader,
    provenance: Provenance,
    *,
    noise: SensorNoise,
    relative: bool,
) -> CoefficientSet:
    """Put the set together."""
    estimate, fit = parts.estimate, parts.estimate.fit
    scale_std = scale_relative_std(parts.scale, parts.source)
    valid = estimate.reason == ColumnState.VALID
    columns = coefficient_columns(
        fit.offset,
        fit.slope,
        variances=parts.variances,
        vignette=parts.vignette,
        shared=parts.shared,
        scale=parts.scale,
        scale_std=scale_std,
    )
    chi2 = parts.reduced_chi_squared
    return CoefficientSet(
        camera=header.camera,
        radiance_unit="1" if relative else header.source.radiance_unit,
        transfer_function=None,
        departures=None,
        **columns,
        dark_current_dn_per_us=np.where(valid, estimate.current.dn_per_us, np.nan),
        dark_current_dn_per_us_std=np.where(valid, estimate.current.std, np.nan),
        reason=estimate.reason,
        scale_relative_std=scale_std,
        system_gain_dn_per_e=noise.system_gain_dn_per_e,
        system_gain_dn_per_e_std=noise.system_gain_dn_per_e_std,
        read_noise_e=noise.read_noise_e,
        read_noise_e_std=noise.read_noise_e_std,
        axis_column=parts.vignette.axis_column,
        axis_column_std=parts.vignette.axis_column_std,
        vignette_order=parts.profile.order,
        reduced_chi_squared=chi2 if np.isfinite(chi2) else None,
        domain=domain_of(
            flats, darks, estimate.fit, parts.scale.radiance_of_reference, header.blocks
        ),
        budget=responsivity_budget(
            fit.slope, parts.variances, parts.vignette, parts.scale, parts.source
        ),
        provenance=replace(
            provenance,
            parameters={**provenance.parameters, "monitor": parts.monitor.verdict},
            radiance_standard=parts.source.standard,
            certificate=parts.source.certificate,
        ),
    )


def _compare(
    parts: Parts, darks: BlockTable, coefficients: CoefficientSet
) -> DarkComparison | None:
    estimate = parts.estimate
    return compare_darks(
        darks,
        estimate.noise,
        estimate.current,
        offset_dn=coefficients.dark_offset_dn,
        shared_offset_variance=_common_offset_std(parts) ** 2,
        block_noise=estimate.block_noise,
        valid=coefficients.valid,
    )


def _common_offset_std(parts: Parts) -> float:
    """Return the standard uncertainty of DN0's mean over columns, DN."""
    shared = parts.shared
    return float(np.sqrt(shared.offset_variance(np.array([shared.mean_slope]))[0]))


def _figures(parts: Parts) -> CalibrationFigures:
    groups, n_columns = parts.groups, len(parts.estimate.reason)
    profile = parts.profile.profile(np.arange(n_columns, dtype=np.float64))
    return CalibrationFigures(
        order_choice=parts.profile.choice,
        profile_slope=profile / parts.scale.radiance_of_reference,
        level=groups.level,
        radiance=groups.radiance,
        relative_level=parts.estimate.fit.relative_level,
        level_ratio=parts.scale.level_ratio,
        level_ratio_std=parts.scale.level_ratio_std,
        level_ratio_seen_std=parts.scale.level_ratio_seen_std,
        source_unrest=parts.shared.source_unrest,
        dark_offset_common_std_dn=_common_offset_std(parts),
        prnu_percent=100.0 * parts.profile.scatter,
    )
