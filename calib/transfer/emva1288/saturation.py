r"""The saturation point: where the camera's highest code begins to cut the noise off.

Source: EMVA Standard 1288, Release 4.0 Linear, section 6.6: the exposure at which between 0.1 and
0.2 % of all samples show the highest code. We take 0.15 %, and go there from the brightest flat
that does not clip more: its samples have the spread σ_tot² = σ²_y + s²_y about its mean µ_y, so
that with a share p at full scale the code that cuts lies Φ⁻¹(1 − p) σ_tot above µ_y. Where too few
clip to be counted, full scale itself is that code, half a step below which rounding decides.

Cameras whose codes never reach full scale saturate in the pixel: there, the exposure of the
largest temporal variance is taken, as in Release 3.1.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from calib.errors import NotDeterminedError
from calib.transfer.emva1288.series import Series

SHARE = 0.0015
MOST = 0.002
_COUNTED = 20
"""So many clipped samples tell their share to a quarter."""
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(64)


@dataclass(frozen=True)
class SaturationPoint:
    """Where to look for saturation, and how.

    Attributes:
        step: Index of the flat that it is reckoned from; -1 where saturation was not reached.
        by_share: Whether by the share of clipped samples; else by the variance's maximum.
        limit_dn: By share: the code that cuts. By maximum: the step's own mean.
        limit_std: Its standard uncertainty.
        reference_dn: Signal above dark that 0 … 70 % and 5 … 95 % are taken of.
        reason: Why there is no saturation point; "" where there is.
    """

    step: int
    by_share: bool
    limit_dn: float
    limit_std: float
    reference_dn: float
    reason: str = ""


def find_saturation(series: Series, full_scale_dn: int, n_pixels: int) -> SaturationPoint:
    """Find it; NotDeterminedError `all-saturated` where every flat clips."""
    shares = np.array([f.share_at_full_scale for f in series.flats])
    sound = np.flatnonzero(~(shares > MOST))
    if not len(sound):
        raise NotDeterminedError(
            "every flat has more than 0.2 % of its samples at the highest code: record flats at "
            "shorter exposures or lower levels",
            code="all-saturated",
        )
    if np.any(shares >= SHARE):
        return _by_share(series, int(sound[-1]), full_scale_dn, n_pixels)
    return _by_maximum(series, full_scale_dn)


def _by_share(series: Series, step: int, full_scale_dn: int, n_pixels: int) -> SaturationPoint:
    flat = series.flats[step]
    total = math.sqrt(flat.variance_dn2 + flat.spatial_dn2)
    samples = n_pixels * flat.n_frames
    share = flat.share_at_full_scale
    counted = share * samples >= _COUNTED
    at = float(norm.isf(share if counted else SHARE))
    pattern = _pattern_variance(at, flat.spatial_dn2 / total**2)
    if counted:
        chance = norm.sf(at) * norm.cdf(at) - pattern  # of each sample, the pattern being given
        limit, variance = flat.mean_dn + at * total, chance / samples
    else:
        limit, variance = full_scale_dn - 0.5, pattern / n_pixels
    std = total * math.sqrt(max(0.0, variance)) / float(norm.pdf(at))
    dark = series.darks[series.dark_of[step]].mean_dn
    reference = float(saturated_signal(limit, flat.mean_dn - dark, dark, flat.variance_dn2,
                                       flat.spatial_dn2))  # fmt: skip
    return SaturationPoint(step, True, limit, std, reference)


def saturated_signal(
    limit_dn: float | np.ndarray,
    signal_dn: float | np.ndarray,
    dark_dn: float | np.ndarray,
    variance_dn2: float | np.ndarray,
    spatial_dn2: float | np.ndarray,
) -> np.ndarray:
    """Return the signal S at which S + dark + Φ⁻¹(1 − 0.15 %) σ_tot(S) = limit.

    σ_tot is carried there from a flat of `signal_dn`: temporal variance with S, spatial with S².
    Everything broadcasts; DN and DN².
    """
    above = float(norm.isf(SHARE))
    ratio = np.ones_like(np.asarray(limit_dn, dtype=np.float64))
    for _ in range(40):  # each turn gains a factor of the spread over the signal
        total = np.sqrt(variance_dn2 * ratio + spatial_dn2 * ratio**2)
        ratio = np.maximum(limit_dn - dark_dn - above * total, 0.0) / signal_dn
    return np.asarray(ratio * signal_dn)


def _pattern_variance(at: float, spatial_share: float) -> float:
    """Return by how much the chance to clip varies from pixel to pixel.

    A pixel's mean takes `spatial_share` of a sample's variance; its chance is Φ of what is left.
    """
    spatial = min(1.0 - 1e-9, max(0.0, spatial_share))
    chance = norm.cdf((_NODES * math.sqrt(spatial) - at) / math.sqrt(1.0 - spatial))
    weights = _WEIGHTS / _WEIGHTS.sum()
    return float(np.sum(weights * chance**2) - np.sum(weights * chance) ** 2)


def _by_maximum(series: Series, full_scale_dn: int) -> SaturationPoint:
    variances = np.array([f.variance_dn2 for f in series.flats])
    means = np.array([f.mean_dn for f in series.flats])
    noise = np.array([f.variance_dn2_std for f in series.flats])
    top = int(np.argmax(variances))
    dark = float(series.darks[series.dark_of[top]].mean_dn)
    after = variances[top + 1 :] + 4.0 * (noise[top + 1 :] + noise[top])
    if not np.any(after < variances[top]):
        reference = full_scale_dn - dark
        reason = (
            "saturation was not reached: no flat has 0.15 % of its samples at the highest code, "
            "and the temporal variance does not fall; record brighter flats"
        )
        return SaturationPoint(-1, False, math.nan, math.nan, reference, reason)
    beside = means[max(0, top - 1) : top + 2]
    half = 0.5 * float(max(beside.max() - means[top], means[top] - beside.min()))
    return SaturationPoint(
        top, False, float(means[top]), half / math.sqrt(3.0), float(means[top]) - dark
    )
