"""How mean, k₂ and k₃ of n samples scatter, for Poisson electrons times a gain plus Gaussian noise.

    var m      = κ₂/n                           cov(m, k₂)  = κ₃/n
    var k₂     = κ₄/n + 2κ₂²/ν                  cov(m, k₃)  = κ₄/n
    var k₃     = κ₆/n + 9(κ₂κ₄ + κ₃²)/ν + 6nκ₂³/((n−1)(n−2))
    cov(k₂,k₃) = κ₅/n + 6κ₂κ₃/ν

with ν = n − 1 (frames less blocks, where several blocks are merged). Source: Kendall and Stuart,
The Advanced Theory of Statistics, vol. 1, chapter 12 (Fisher's k-statistics).

DN = G·K + B + n has κ_r = G^r·λ for r ≥ 3: with q = G·λ, the signal in DN, κ_r = G^(r−1)·q. Read
noise is Gaussian and adds to κ₂ alone; rounding adds 1/12 DN² to κ₂, and −1/120 DN⁴ to κ₄, which is
left out. κ₂ is what was measured; κ₂² and κ₂³ are estimated without bias (E k₂² exceeds κ₂²), so
that sums of these variances over pixels are right at few frames, too.
"""

from dataclasses import dataclass

import numpy as np

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair


@dataclass(frozen=True)
class SamplingCovariance:
    """Of one exposure's mean, k₂ and k₃, each (n_pixels,).

    Attributes:
        mean: var m, DN².
        mean_variance: cov(m, k₂), DN³.
        variance: var k₂, DN⁴.
        mean_third: cov(m, k₃), DN⁴.
        variance_third: cov(k₂, k₃), DN⁵.
        third: var k₃, DN⁶.
    """

    mean: Pixels
    mean_variance: Pixels
    variance: Pixels
    mean_third: Pixels
    variance_third: Pixels
    third: Pixels


def sampling_covariances(
    pair: ExposurePair, gain_dn_per_e: float
) -> tuple[SamplingCovariance, SamplingCovariance]:
    """Return those of both exposures; `gain_dn_per_e` is a typical one, for κ₃ and higher."""
    signal = np.maximum(pair.difference_dn, 0.0) / (pair.ratio - 1.0)
    return (
        sampling_covariance(pair.first, signal, gain_dn_per_e),
        sampling_covariance(pair.second, pair.ratio * signal, gain_dn_per_e),
    )


def sampling_covariance(
    moments: ExposureMoments, signal_dn: Pixels, gain_dn_per_e: float
) -> SamplingCovariance:
    """Return it for pixels of the signal q = `signal_dn`, DN without the bias."""
    n, free, k2, g = moments.n_frames, moments.n_free, moments.variance_dn2, gain_dn_per_e
    third, fourth = g**2 * signal_dn, g**3 * signal_dn
    squared = (k2**2 - fourth / n) * free / (free + 2.0)
    cubed = k2**3 / (1.0 + 6.0 / free + 8.0 / free**2)
    gaussian = 6.0 * n / max((n - 1.0) * (n - 2.0), 1.0) * cubed
    return SamplingCovariance(
        mean=k2 / n,
        mean_variance=third / n,
        variance=fourth / n + 2.0 * np.maximum(squared, 0.0) / free,
        mean_third=fourth / n,
        variance_third=g**4 * signal_dn / n + 6.0 * k2 * third / free,
        third=g**5 * signal_dn / n + 9.0 * (k2 * fourth + third**2) / free + gaussian,
    )
