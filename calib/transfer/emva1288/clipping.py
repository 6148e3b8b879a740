r"""From the brightest flat whose pixels do not clip to where 0.15 % of the samples do.

The flat's pixels are carried to the signal S = q S_flat: their pattern grows with q, their shot
noise with √q. A sample of a pixel of mean m is at full scale with the chance that noise of the
variance σ² and the third cumulant κ₃ = (shot variance)²/S that Poisson's law gives exceeds
c − m, c being half a step below full scale, where rounding decides. With x = (c − m)/σ that is
Φ(−x) + κ₃ (x² − 1) φ(x)/(6 σ³), Edgeworth's first term. The mean chance of all pixels is 0.15 %
at saturation: rows, columns and hot pixels count as they are, nothing is taken to be normal but
the noise.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import norm

from calib.transfer.emva1288.block_image import Image
from calib.transfer.emva1288.saturation import SHARE, SaturationPoint
from calib.transfer.emva1288.series import Series

_CLASSES = 4096
_ORDERS = 200
_UNTOUCHED = 2e-5
"""Up to this share at full scale no pixel's mean is held down: the tail of noise alone clips."""
Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class _Carried:
    """A flat whose pixels can be carried to other signals.

    Attributes:
        off: Pixels' deviations from the mean, less their temporal noise, by classes, DN.
        weight: Share of the pixels in each class.
        signal_dn: Above dark.
        dark_dn: The dark's mean.
        shot_dn2: Temporal variance above the dark's.
        dark_dn2: The dark's temporal variance.
        limit_dn: From here on a sample is rounded to full scale, or clipped.
    """

    off: Numbers
    weight: Numbers
    signal_dn: float
    dark_dn: float
    shot_dn2: float
    dark_dn2: float
    limit_dn: float

    def chances(self, ratio: float) -> Numbers:
        """Return each class's chance to clip at `ratio` times the flat's signal."""
        signal = ratio * (self.signal_dn + self.off)
        per_dn = self.shot_dn2 / self.signal_dn  # a brighter pixel has more shot noise, too
        variance = self.dark_dn2 + per_dn * signal
        x = (self.limit_dn - self.dark_dn - signal) / np.sqrt(variance)
        skewness = per_dn**2 * signal / variance**1.5
        edgeworth = skewness / 6.0 * (x**2 - 1.0) * norm.pdf(x)
        found: Numbers = np.clip(norm.sf(x) + edgeworth, 0.0, 1.0)
        return found

    def share(self, ratio: float) -> float:
        """Return the share of all samples that clip."""
        return float(np.sum(self.weight * self.chances(ratio)))


def carrier_of(point: SaturationPoint, series: Series) -> int:
    """Return the index of the brightest flat up to the point's whose pixels do not clip."""
    upto = series.flats[: point.step + 1]
    untouched = [k for k, f in enumerate(upto) if f.share_at_full_scale <= _UNTOUCHED]
    return untouched[-1] if untouched else point.step


def clipped_point(
    point: SaturationPoint, series: Series, carrier: int, image: Image, full_scale_dn: int
) -> SaturationPoint:
    """Return the saturation point from the carrier's averaged image, (n_rows, n_columns).

    Its uncertainty is that of the temporal variance, and `_hidden_tail`.
    """
    flat, dark = series.flats[carrier], series.darks[series.dark_of[carrier]]
    noise = flat.within_dn2 / flat.n_frames
    hidden = noise / max(noise + flat.spatial_dn2, 1e-12)
    count, edges = np.histogram(image, bins=_CLASSES)
    carried = _Carried(
        off=math.sqrt(1.0 - hidden) * (0.5 * (edges[1:] + edges[:-1]) - flat.mean_dn),
        weight=count / image.size,
        signal_dn=flat.mean_dn - dark.mean_dn,
        dark_dn=dark.mean_dn,
        shot_dn2=max(0.0, flat.variance_dn2 - dark.variance_dn2),
        dark_dn2=dark.variance_dn2,
        limit_dn=full_scale_dn - 0.5,
    )
    first = point.reference_dn / carried.signal_dn
    ratio = float(brentq(lambda q: carried.share(q) - SHARE, 0.5 * first, 1.5 * first))
    spatial = flat.spatial_dn2 * ratio**2
    total = math.sqrt(flat.variance_dn2 * ratio + spatial)
    by_pattern = total * _hidden_tail(spatial / total**2, hidden, image.size)
    by_noise = float(norm.isf(SHARE)) * ratio * flat.variance_dn2_std / (2.0 * total)
    signal = ratio * carried.signal_dn
    return replace(
        point,
        mean_dn=signal + dark.mean_dn,
        mean_std=math.hypot(by_pattern, by_noise),
        reference_dn=signal,
    )


def _hidden_tail(spatial: float, hidden: float, pixels: int) -> float:
    r"""Return what the pixels' noise hides of the pattern's tail, in spreads of a sample.

    √(Σ_n r^n He²_(n−1)(z)/n! · 2 (1 − (1 − ρ)^(n/2)) / NM) over n ≥ 2: the pattern takes r of a
    sample's variance, its noise ρ of the averages'; z cuts 0.15 % off a normal distribution, of
    whose pattern the chance to clip has the Hermite coefficients r^(n/2) φ(z) He_(n−1)(z)/√n!, and
    each is seen through the correlation (1 − ρ)^(n/2). The mean, n = 1, is measured.
    """
    z = float(norm.isf(SHARE))
    last, now = 1.0, z / math.sqrt(2.0)  # He_(n−1)/√n! for n = 1 and 2
    summed = 0.0
    for n in range(2, _ORDERS):
        summed += spatial**n * now**2 * 2.0 * (1.0 - (1.0 - hidden) ** (n / 2))
        # He_n = z He_(n−1) − (n − 1) He_(n−2)
        last, now = now, (z * now - (n - 1) / math.sqrt(n) * last) / math.sqrt(n + 1)
    return math.sqrt(summed / pixels)
