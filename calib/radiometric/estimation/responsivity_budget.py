"""The uncertainty budget of the responsivity at a typical column, relative."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from calib.arrays import Columns
from calib.budget import Budget, BudgetRow
from calib.radiometric.estimation.assemble import LineVariances
from calib.radiometric.estimation.normalised_profile import Vignette
from calib.radiometric.estimation.scale import RadianceScale
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty


def responsivity_budget(
    slope: Columns,
    variances: LineVariances,
    vignette: Vignette,
    scale: RadianceScale,
    source: SourceUncertainty,
) -> Budget:
    """Return the rows; those of single columns are the medians over the valid ones."""
    valid = np.isfinite(slope)
    own = np.sqrt(variances.slope[valid]) / slope[valid]
    rest = np.sqrt(np.maximum(1.0 - 2.0 * vignette.own_noise_share[valid], 0.0))
    kind: Literal["A", "B"] = "B" if source.level_relative_std is not None else "A"
    rows = [
        BudgetRow(
            "slope of the column's line", "A", "normal", float(np.median(own)), "1",
            float(np.median(rest)), "column", "weighted least squares, photon-transfer weights",
        ),
        BudgetRow(
            "vignette profile", "A", "normal", float(np.median(vignette.relative_std[valid])), "1",
            1.0, "column", "polynomial fit through PRNU, normalised at its maximum",
        ),
        BudgetRow(
            "unrest of the source between blocks", "A", "student-t", scale.by_source_unrest, "1",
            1.0, "common", "what the columns' residuals share",
        ),
        BudgetRow(
            "offsets common to a line", "A", "student-t", _by_offset(vignette, scale),
            "1", 1.0, "common", "scatter of the capped darks, at the axis",
        ),
        BudgetRow(
            "radiance of single levels", kind, "normal", scale.by_levels, "1",
            1.0, "common", "stated" if kind == "B" else "scatter of the levels",
        ),
        BudgetRow(
            "certified radiance", "B", "normal", source.certificate_relative_std or 0.0, "1",
            1.0, "common", source.certificate or _stated(source.certificate_relative_std),
        ),
        BudgetRow(
            "uniformity of the source", "B", "rectangular",
            (source.nonuniformity_relative or 0.0) / float(np.sqrt(3.0)), "1",
            1.0, "common", _stated(source.nonuniformity_relative),
        ),
        BudgetRow(
            "monitor", "B", "normal", source.monitor_relative_std or 0.0, "1",
            1.0, "common", _stated(source.monitor_relative_std),
        ),
    ]  # fmt: skip
    return Budget("responsivity", "1", (*rows, *_computed(source)))


def _by_offset(vignette: Vignette, scale: RadianceScale) -> float:
    """Return what QE at the axis has of them: their part of the slope and of the scale."""
    line = scale.by_offset.slope_relative_std(np.asarray(vignette.axis_slope))
    return float(np.hypot(line, scale.by_offset.scale_std))


def _computed(source: SourceUncertainty) -> Iterator[BudgetRow]:
    """Yield what radiances have in addition that were computed from spectra."""
    if source.spectral_response_relative_std is not None:
        yield BudgetRow(
            "spectral response in the band radiance", "B", "normal",
            source.spectral_response_relative_std, "1", 1.0, "common",
            "of the response, propagated through the lamps' spectra",
        )  # fmt: skip


def _stated(value: float | None) -> str:
    """Return whether a number was given."""
    return "not stated, taken as 0" if value is None else "stated"
