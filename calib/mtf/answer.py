"""What `darkflat mtf` answers of a grating's scan: contract §6."""

from typing import Any

import numpy as np

from calib.mtf.findings import stage_outliers, stage_rms_um, warnings
from calib.mtf.measure import Measurement
from calib.mtf.result import TransferResult


def answer(result: TransferResult) -> dict[str, Any]:
    """Return the JSON answer; None for what the pattern does not determine."""
    found, zeros, nyquist = result.measurement, result.first_zeros, result.nyquist
    known = [each.std for each in nyquist.values() if each.is_known]
    return {
        "transfer_function": result.id,
        "method": found.method,
        "first_zero_per_mm": [each.answer()["value"] for each in zeros],
        "first_zero_std_per_mm": [each.answer()["std"] for each in zeros],
        "mtf_at_nyquist": {
            **{axis: each.answer()["value"] for axis, each in nyquist.items()},
            "std": max(known, default=None),
        },
        "mean_transfer_std": result.mean_std,
        "valid_percent": 100 * _valid_share(result),
        **_about_the_bench(found),
        "warnings": [
            *(f"mtf.toml: unknown key {key} is left out" for key in result.unknown_keys),
            *warnings(found),
            *_about_the_filter(result),
        ],
    }


def _about_the_bench(found: Measurement) -> dict[str, Any]:
    tilt, excess = found.fit.tilt_rad, found.psf.mean_excess
    return {
        "grating_shift_um": found.shift_um.tolist(),
        "grating_shift_std_um": np.sqrt(np.diag(found.shift_covariance)).tolist(),
        "tilt_error_deg": {"value": np.degrees(tilt[0]), "std": np.degrees(tilt[1])},
        "scale_error": {"value": found.fit.scale[0], "std": found.fit.scale[1]},
        "stage_rms_um": stage_rms_um(found),
        "stage_outliers": [
            {"position": each.position, "error_um": each.error_um, "std_um": each.std_um}
            for each in stage_outliers(found)
        ],
        "light_without_pattern_percent": {"value": 100 * excess[0], "std": 100 * excess[1]},
        "gain_scatter_percent": 100 * found.fit.gain_std,
        "noise_relative": found.fit.noise / found.fit.mean,
        "pixels_left_out": int((~found.fit.good).sum()),
        "positions_used": len(found.fit.state.sampling.frames),
    }


def _about_the_filter(result: TransferResult) -> list[str]:
    """Return by how much the paper's filter misses what harmonics and support say."""
    found = result.measurement
    if found.method != "filter":
        return []
    axis = found.frequency_per_um
    both = result.values.valid & (better := found.psf.at(axis, axis)).valid
    away = float(np.abs(result.values.transfer - better.transfer)[both].max())
    told = f"the filter differs from the regularised estimate by up to {away:.2g}, since its"
    return [f"{told} window smooths the transfer function; its uncertainty is of noise alone"]


def _valid_share(result: TransferResult) -> float:
    """Of the disc of harmonics."""
    axis = result.measurement.frequency_per_um
    disc = np.hypot(*np.meshgrid(axis, axis)) <= result.measurement.grating.max_frequency_per_um
    return float(result.values.valid[disc].mean())
