"""How much the spectral response changes with the angle of incidence, and whether it is seen.

An interference filter's band moves to the blue as 1 - sin²θ/(2 n²) does (n: its effective index).
The photodiode's responsivity is the same at all angles, so that its uncertainty plays no part here.
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.radiometric.spectral.spectral_response import Figure, SpectralResponse
from calib.radiometric.spectral.spectral_response_scan import SpectralScan


@dataclass(frozen=True)
class AngleComparison:
    """One angle against the reference angle, after one common factor has been fitted.

    Attributes:
        angle_deg: The angle.
        scale: The factor: vignette and alignment, not the shape of the band.
        centroid_shift_nm: Of ∫λR/∫R.
        rms_difference: Of the shapes, relative to the peak.
        rms_expected: What noise alone would give.
        significance_sigma: Of the difference in shape, as a normal deviate; about 0 +- 1 where
            there is none.
    """

    angle_deg: float
    scale: Figure
    centroid_shift_nm: Figure
    rms_difference: float
    rms_expected: float
    significance_sigma: float


def angular_variation(
    scan: SpectralScan, reference_deg: float = 0.0
) -> tuple[AngleComparison, ...]:
    """Return each other angle of the scan against `reference_deg`."""
    reference = scan.index_of(reference_deg)
    return tuple(
        _compared(scan, index, reference)
        for index in range(len(scan.angle_deg))
        if index != reference
    )


def _compared(scan: SpectralScan, index: int, reference: int) -> AngleComparison:
    ours, ours_std = scan.response[index], scan.std[index]
    theirs, theirs_std = scan.response[reference], scan.std[reference]
    scale = _common_factor(ours, ours_std, theirs, theirs_std)
    difference = (ours - scale.value * theirs) / (scale.value * theirs.max())
    std = np.hypot(ours_std, scale.value * theirs_std) / (scale.value * theirs.max())
    seen = std > 0
    chi_squared = float(np.sum((difference[seen] / std[seen]) ** 2))
    centroids = [
        SpectralResponse.normalised(scan.wavelength_nm, scan.response[i], scan.std[i]).centroid_nm
        for i in (index, reference)
    ]
    return AngleComparison(
        angle_deg=float(scan.angle_deg[index]),
        scale=scale,
        centroid_shift_nm=Figure(
            centroids[0].value - centroids[1].value,
            float(np.hypot(centroids[0].std, centroids[1].std)),
        ),
        rms_difference=float(np.sqrt(np.mean(difference**2))),
        rms_expected=float(np.sqrt(np.mean(std**2))),
        significance_sigma=_as_normal_deviate(chi_squared, max(int(seen.sum()) - 1, 1)),
    )


def _common_factor(
    ours: Columns, ours_std: Columns, theirs: Columns, theirs_std: Columns
) -> Figure:
    """Fit ours = factor x theirs by least squares with errors in both."""
    factor = float(np.sum(ours * theirs) / np.sum(theirs**2))
    information = np.inf
    for _ in range(3):
        variance = ours_std**2 + (factor * theirs_std) ** 2
        if not (variance > 0).all():
            return Figure(factor, 0.0)
        weighted = theirs / variance
        information = float(np.sum(weighted * theirs))
        factor = float(np.sum(weighted * ours)) / information
    return Figure(factor, information**-0.5)


def _as_normal_deviate(chi_squared: float, dof: int) -> float:
    """Return chi-squared as a normal deviate (Wilson and Hilferty 1931), good far into the tail."""
    spread = 2.0 / (9.0 * dof)
    return float(((chi_squared / dof) ** (1 / 3) - (1.0 - spread)) / spread**0.5)
