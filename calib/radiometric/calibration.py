"""What `calibrate` hands back: the set, how good it is, and what there is to look at."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from calib.arrays import Columns
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.estimation.dark_comparison import DarkComparison
from calib.radiometric.estimation.order_choice import OrderChoice
from calib.radiometric.uniformity import Uniformity
from calib.recording.block_statistics import RecordingStatistics


@dataclass(frozen=True)
class CalibrationFigures:
    """Numbers behind the report's figures.

    Attributes:
        order_choice: Orders of the vignette's polynomial, compared.
        profile_slope: The smooth profile, DN per radiance per µs, (n_columns,): Fig. 3(b) in red.
        level: Level of each group.
        radiance: Its certified radiance; NaN where unknown.
        relative_level: What the camera sees of it, 1 for the reference: Fig. 5.
        level_ratio: Certified over seen, less 1; NaN where unknown.
        level_ratio_std: Its standard uncertainty, the levels' own certified one included.
        level_ratio_seen_std: The part of it that is the camera's.
        source_unrest: Relative scatter of the source between blocks; NaN where not testable.
        dark_offset_common_std_dn: Standard uncertainty of DN0's mean over columns, DN.
        prnu_percent: ε, scatter of the slopes about the profile without their noise.
    """

    order_choice: OrderChoice
    profile_slope: Columns
    level: Columns
    radiance: Columns
    relative_level: Columns
    level_ratio: Columns
    level_ratio_std: Columns
    level_ratio_seen_std: Columns
    source_unrest: float
    dark_offset_common_std_dn: float
    prnu_percent: float


@dataclass(frozen=True)
class Calibration:
    """A coefficient set and its examination.

    Attributes:
        coefficients: The set.
        darks: Capped darks against intercepts; None without darks.
        uniformity: Before and after, on held-out lines; None where there are none.
        figures: Numbers for the report.
        warnings: What a bench operator should know, one sentence each.
        without_departures: The statistics that the set was made from, where those of a model were
            taken out of the recording's; None where they are the recording's.
    """

    coefficients: CoefficientSet
    darks: DarkComparison | None
    uniformity: Uniformity | None
    figures: CalibrationFigures
    warnings: tuple[str, ...]
    without_departures: RecordingStatistics | None = None

    def answer(self) -> dict[str, Any]:
        """Return what `darkflat calibrate --json` prints; an unknown number is None."""
        summary, told = self.coefficients.summary(), self.coefficients.departures
        keep = (
            "coefficient_set", "columns", "valid_columns", "masked", "vignette_order",
            "axis_column", "axis_column_std", "edge_fall_percent", "responsivity_at_axis",
            "scale_relative_std", "system_gain_dn_per_e", "read_noise_e", "reduced_chi_squared",
        )  # fmt: skip
        return {
            **{key: summary[key] for key in keep},
            "axis_column": round(summary["axis_column"]),
            "axis_column_exact": float(summary["axis_column"]),
            "mean_dark_offset_dn": {
                "regression": summary["mean_dark_offset_dn"],
                "capped": self.darks.capped_mean_dn if self.darks else None,
                "capped_raw": self.darks.capped_raw_mean_dn if self.darks else None,
            },
            "dark_offset_difference_dn": self._difference(),
            **self._variation(),
            "prnu_percent": self.figures.prnu_percent,
            "vignette_order_by_residual": self.figures.order_choice.by_residual,
            "departures": None if told is None else told.taken_out,
            "warnings": list(self.warnings),
        }

    def _difference(self) -> Mapping[str, float | int | None] | None:
        """Return capped darks less intercepts."""
        if self.darks is None:
            return None
        return {
            "value": _known(self.darks.difference_dn),
            "std": _known(self.darks.difference_std_dn),
            "significance_sigma": _known(self.darks.significance_sigma),
            "columns": self.darks.columns,
            "clipping_columns": self.darks.clipping_columns,
        }

    def _variation(self) -> Mapping[str, float | str | int | None]:
        """Return the coefficients of variation, None where no line was held out."""
        u = self.uniformity
        return {
            "cov_before_percent": u.before if u else None,
            "cov_after_percent": u.after if u else None,
            "cov_before_single_line_percent": u.before_single_line if u else None,
            "cov_after_single_line_percent": u.after_single_line if u else None,
            "cov_before_offset_removed_percent": u.before_offset_removed if u else None,
            "cov_block": u.block if u else None,
            "cov_lines": u.n_lines if u else None,
        }


def _known(value: float) -> float | None:
    """Return None for a number that JSON does not know."""
    return value if math.isfinite(value) else None
