"""What is said of a monochromator scan: the band's figures, the drift, the angles."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from calib.errors import NotDeterminedError
from calib.radiometric.spectral.spectral_response import Figure, SpectralResponse
from calib.radiometric.spectral.spectral_response_angles import AngleComparison, angular_variation
from calib.radiometric.spectral.spectral_response_scan import SpectralScan

DIFFERENT_SIGMA = 4.0


def response_answer(scan: SpectralScan, angle_deg: float = 0.0) -> dict[str, Any]:
    """Return what `darkflat spectral-response --json` answers; what is not determined is None.

    Figures are `{"value", "std"}`, drifts and fractions are relative.

    Raises:
        InputError: `no-such-angle`.
        NotDeterminedError: `no-response`.
    """
    response = scan.at_angle(angle_deg)
    angles = angular_variation(scan, angle_deg)
    centre, why_no_width = _determined(lambda: response.centre_wavelength_nm)
    width, _ = _determined(lambda: response.fwhm_nm)
    leak = response.out_of_band_fraction
    return {
        "angle_deg": float(scan.angle_deg[scan.index_of(angle_deg)]),
        "wavelengths": len(scan.wavelength_nm),
        "range_nm": [float(scan.wavelength_nm[0]), float(scan.wavelength_nm[-1])],
        "centre_wavelength_nm": centre,
        "fwhm_nm": width,
        "centroid_nm": asdict(response.centroid_nm),
        "bandwidth_nm": asdict(response.bandwidth_nm),
        "band_nm": list(response.band_nm) if response.band_nm else None,
        "out_of_band_fraction": asdict(leak) if leak else None,
        "largest_std": float(response.std.max()),
        "drift": {
            "largest": scan.largest_drift,
            "rms_by_angle": [
                {"angle_deg": float(angle), "rms": float(np.sqrt(np.mean(drift**2)))}
                for angle, drift in zip(scan.angle_deg, scan.drift, strict=True)
            ],
        },
        "angles": [asdict(angle) for angle in angles],
        "warnings": [why_no_width] * bool(why_no_width) + list(_findings(response, angles)),
    }


def _determined(figure: Callable[[], Figure]) -> tuple[dict[str, float] | None, str]:
    """Return a figure, or None and why there is none."""
    try:
        return asdict(figure()), ""
    except NotDeterminedError as error:
        return None, str(error)


def _findings(response: SpectralResponse, angles: Sequence[AngleComparison]) -> Iterator[str]:
    """Yield what whoever made the scan should know, one sentence each."""
    if response.band_nm is None:
        yield "The response does not fall to 1 % on both sides: what is out of band is not known."
    moved = [angle for angle in angles if angle.significance_sigma > DIFFERENT_SIGMA]
    if moved:
        most = max(moved, key=lambda angle: angle.significance_sigma)
        yield (
            f"The band changes with the angle of incidence: at {most.angle_deg:g}° its centroid "
            f"lies {most.centroid_shift_nm.value:+.2f} ± {most.centroid_shift_nm.std:.2f} nm off "
            f"({most.significance_sigma:.1f} sigma)."
        )
