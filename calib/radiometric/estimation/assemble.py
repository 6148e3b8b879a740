"""From lines, profile and scale to a coefficient set with its uncertainties.

With s the slope in DN per µs of reference light and c the radiance of that light:

    slope          S = s / c                      VE·QE, DN per radiance per µs
    vignette       VE = p / max p                 p the smooth profile of s
    responsivity   QE = S / VE
    u²(S)/S²     = u²(s)/s² + u²(shape) + u²(α)·(s̄/s + κ)²    without the scale's
    u²(QE)/QE²   = (1 − 2h)·u²(s)/s² + u²(VE)/VE² + u²(α)·(s̄/p(i0) + κ)² + u²(scale)

h is the share of a column's own slope error that VE takes up, so that the quotient does not see
it. PRNU's scatter enters VE, and through VE it enters QE. The source's shape enters VE and S alike
and cancels in QE. An offset that all columns share shifts all slopes by the same DN/µs, α in units
of the mean slope (`common_offset`): VE takes up its shape, and QE sees what it is at the axis.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.radiometric.estimation.common_mode import CommonMode
from calib.radiometric.estimation.normalised_profile import Vignette
from calib.radiometric.estimation.scale import RadianceScale
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty


@dataclass(frozen=True)
class LineVariances:
    """Of each column's own DN0 and s, (n_columns,): everything but what columns share."""

    offset: Columns
    slope: Columns
    covariance: Columns


def scale_relative_std(scale: RadianceScale, source: SourceUncertainty) -> float:
    """Return the relative standard uncertainty of the radiance scale, common to all columns."""
    parts = (
        scale.by_levels,
        scale.by_source_unrest,
        scale.by_offset.scale_std,
        source.certificate_relative_std or 0.0,
        (source.nonuniformity_relative or 0.0) / np.sqrt(3.0),
        source.monitor_relative_std or 0.0,
        source.spectral_response_relative_std or 0.0,
    )
    return float(np.sqrt(sum(part**2 for part in parts)))


def coefficient_columns(
    offset: Columns,
    slope: Columns,
    *,
    variances: LineVariances,
    vignette: Vignette,
    shared: CommonMode,
    scale: RadianceScale,
    scale_std: float,
) -> Mapping[str, Columns]:
    """Return the per-column fields of a `CoefficientSet` but reason and dark current.

    Args:
        offset: DN0, DN; NaN where masked.
        slope: s, DN per µs of reference light.
        variances: Of both.
        vignette: VE.
        shared: What all columns share; its part of DN0 and of the covariance is added here, and
            of the slope what is not the same share of all columns; the rest is in `scale_std`.
        scale: The radiance scale.
        scale_std: From `scale_relative_std`.
    """
    c = scale.radiance_of_reference
    share = slope / shared.mean_slope
    absolute = slope / c
    own = np.sqrt(variances.slope) / slope
    ratio = (1.0 - 2.0 * vignette.own_noise_share) * own**2
    responsivity = absolute / vignette.values
    at_axis = scale.by_offset.slope_relative_std(np.asarray(vignette.axis_slope))
    common = np.hypot(scale_std, at_axis)
    relative = np.sqrt(np.maximum(ratio, 0.0) + vignette.relative_std**2 + common**2)
    of_slope = own**2 + vignette.uniformity_relative_std**2
    of_slope = of_slope + scale.by_offset.slope_relative_std(slope) ** 2
    return {
        "dark_offset_dn": offset,
        "dark_offset_dn_std": np.sqrt(variances.offset + shared.offset_variance(slope)),
        "vignette": vignette.values,
        "vignette_std": vignette.std,
        "responsivity": responsivity,
        "responsivity_std": responsivity * relative,
        "slope": absolute,
        "slope_std": absolute * np.sqrt(of_slope),
        "offset_slope_covariance": variances.covariance / c
        + absolute
        * (share * scale.offset_covariance_dn + scale.by_offset.offset_covariance_dn(slope)),
    }
