"""Why a figure is not determined, one sentence for each case."""

import math

from calib.recording.header import CameraHeader, SourceHeader
from calib.transfer.emva1288.catalogue import CATALOGUE, Figure
from calib.transfer.emva1288.formulas import DARK_LIMIT_DN, LEAST_DARK_DN2, Formulas
from calib.transfer.estimate import Estimate

Found = dict[str, tuple[float, float]]
LEAST_SIGMAS = 2.0
"""A spatial variance closer to zero than this many of its uncertainties has no square root."""
SUMS_ALONE = "only sums of each block survive: this needs its frames"
_ONE_ROW = "a line sensor has one row: its nonuniformity along the line is the total"
_QUANTISED = ("read_noise_dn", "read_noise_e")
_THRESHOLDS = ("sensitivity_threshold_e", "sensitivity_threshold_photons")


def estimates(
    found: Found, formulas: Formulas, camera: CameraHeader, source: SourceHeader
) -> dict[str, Estimate]:
    """Return an estimate for every figure of the catalogue, known or with its reason."""
    told = {}
    for figure in CATALOGUE:
        value, std = found.get(figure.name, (math.nan, math.nan))
        reason = _why_not(figure, found, formulas, camera, source)
        if not reason and not (math.isfinite(value) and math.isfinite(std)):
            reason = "noise makes it the root or the logarithm of a negative number"
        told[figure.name] = (
            Estimate.unknown(figure.unit, reason) if reason else Estimate(value, std, figure.unit)
        )
    return told


def _why_not(
    figure: Figure, found: Found, formulas: Formulas, camera: CameraHeader, source: SourceHeader
) -> str:
    name = figure.name
    if figure.scaled_by_photons and source.photons_per_pixel_per_us is None:
        return "recording.toml states no photons_per_pixel_per_us: add it to [source]"
    if name == "quantum_efficiency" and source.wavelength_nm is None:
        return "a quantum efficiency is one at a wavelength: add wavelength_nm to [source]"
    if not found["system_gain_dn_per_e"][0] > 0 and figure.unit != "DN":
        return "the temporal variance does not grow with the signal: there is no system gain"
    quantised = _quantised(name, found)
    if quantised:
        return quantised
    if name not in found or figure.section == "spatial":
        return _missing(figure, found, formulas, camera)
    return ""


def _quantised(name: str, found: Found) -> str:
    """Eq. 54: below 0.24 DN² the dark noise is quantisation's."""
    dark = found["temporal_dark_variance_dn2"][0]
    if dark >= LEAST_DARK_DN2 or not name.startswith((*_QUANTISED, *_THRESHOLDS, "dynamic_range")):
        return ""
    gain = found["system_gain_dn_per_e"][0]
    why = f"the dark variance, {dark:.3g} DN², is below {LEAST_DARK_DN2} DN²: quantisation hides "
    if name in _QUANTISED:
        bound = DARK_LIMIT_DN if name.endswith("dn") else DARK_LIMIT_DN / gain
        return f"{why}the dark noise, which is below {bound:.3g} {name[-2:].strip('_')} (Eq. 54)"
    least = math.sqrt(LEAST_DARK_DN2 / gain**2 + 0.25) + 0.5
    return f"{why}the dark noise; the threshold is below {least:.3g} e-"


def _missing(figure: Figure, found: Found, formulas: Formulas, camera: CameraHeader) -> str:
    name = figure.name
    if figure.section == "spatial":
        return _unresolved(name, found, formulas, camera)
    if figure.section == "linearity" and not formulas.point.reason:
        n = len(formulas.fits.linearity)
        return f"only {n} flat(s) lie in 5 … 95 % of saturation: record three or more"
    if name == "dark_current_doubling_c":
        return "the darks are at one temperature: record darks at several"
    if figure.section == "dark_current":
        return "the darks are at one exposure: record darks at six or more"
    return formulas.point.reason


def _unresolved(name: str, found: Found, formulas: Formulas, camera: CameraHeader) -> str:
    if formulas.spatial is None:
        return SUMS_ALONE
    if camera.rows is None and any(part in name for part in ("_row", "_column", "_pixel")):
        return _ONE_ROW
    stem = "_".join(name.split("_")[:-1])
    value, std = found.get(f"variance of {stem}", (math.inf, 0.0))
    if value > LEAST_SIGMAS * std:
        return ""
    return f"not resolved: its variance is {value:.2g} ± {std:.2g} DN²; average more frames"
