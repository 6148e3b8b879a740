r"""The saturation point: where the camera's highest code begins to cut the noise off.

Source: EMVA Standard 1288, Release 4.0 Linear, section 6.6: the exposure at which between 0.1 and
0.2 % of all samples show the highest code. We take 0.15 %, and go there from the brightest flat
that does not clip more (`clipping`).

Cameras whose codes never reach full scale saturate in the pixel: there, the exposure of the
largest temporal variance is taken, as in Release 3.1.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from calib.errors import NotDeterminedError
from calib.transfer.emva1288.block_figures import BlockFigures
from calib.transfer.emva1288.series import Series

SHARE = 0.0015
MOST = 0.002


@dataclass(frozen=True)
class SaturationPoint:
    """Where saturation lies.

    Attributes:
        step: Index of the flat that it is reckoned from; -1 where saturation was not reached.
        by_share: Whether by the share of clipped samples; else by the variance's maximum.
        mean_dn: µ_y.sat, the mean code there.
        mean_std: Its standard uncertainty.
        reference_dn: Signal above dark that 0 … 70 % and 5 … 95 % are taken of.
        reason: Why there is no saturation point; "" where there is.
    """

    step: int
    by_share: bool
    mean_dn: float
    mean_std: float
    reference_dn: float
    reason: str = ""


def find_saturation(series: Series, full_scale_dn: int) -> SaturationPoint:
    """Find it from the blocks' figures; NotDeterminedError `all-saturated` where every flat clips.

    By share, it is a first approximation: as if samples were distributed normally.
    """
    shares = np.array([f.share_at_full_scale for f in series.flats])
    sound = np.flatnonzero(~(shares > MOST))
    if not len(sound):
        raise NotDeterminedError(
            "every flat has more than 0.2 % of its samples at the highest code: record flats at "
            "shorter exposures or lower levels",
            code="all-saturated",
        )
    if np.any(shares >= SHARE):
        return _by_share(series, int(sound[-1]), full_scale_dn)
    return _by_maximum(series, full_scale_dn)


def _by_share(series: Series, step: int, full_scale_dn: int) -> SaturationPoint:
    flat, dark = series.flats[step], series.darks[series.dark_of[step]].mean_dn
    signal = _saturated_signal(flat, dark, full_scale_dn - 0.5)
    return SaturationPoint(step, True, signal + dark, math.nan, signal)


def _saturated_signal(flat: BlockFigures, dark_dn: float, limit_dn: float) -> float:
    """Return the signal S at which S + dark + Φ⁻¹(1 − 0.15 %) σ_tot(S) = limit, DN.

    σ²_tot = σ²_y + s²_y is carried there from the flat: the one with S, the other with S².
    """
    above, signal, ratio = float(norm.isf(SHARE)), flat.mean_dn - dark_dn, 1.0
    for _ in range(40):  # each turn gains a factor of the spread over the signal
        total = math.sqrt(flat.variance_dn2 * ratio + flat.spatial_dn2 * ratio**2)
        ratio = max(limit_dn - dark_dn - above * total, 0.0) / signal
    return ratio * signal


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
