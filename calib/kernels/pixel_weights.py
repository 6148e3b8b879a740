"""Weights of pixels in pooled estimates, compiled; `two_exposures.weights` says why these.

With q̃ the signal smoothed over neighbours, σ₁² = Gq̃ + σ² and σ₂² = rGq̃ + σ² (G and σ² of the whole
sensor) and uₖ = 2σₖ⁴/νₖ:

    q = the mean of D̄₁ and D̄₂ that does not go with D, less the bias; in a within q̃/4 … 4q̃
    a = q̃²/(u₁ + u₂)/q               of V and D in the gain
    β = 1/((1 + 1/ρ)²u₁ + u₂/ρ²)     of the read noise variance
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.exposure_arrays import PairArrays
from calib.kernels.pixel_sums import Pixels

_FARTHEST = 4.0  # a pixel's signal from its neighbours', as a factor


class Typical(NamedTuple):
    """One gain, read noise and bias for all pixels."""

    gain_dn_per_e: float
    read_dn2: float
    bias_dn: float


def pixel_weights(
    pair: PairArrays, smooth_dn: Pixels, where: NDArray[np.bool_], typical: Typical
) -> tuple[Pixels, Pixels, Pixels]:
    """Return a, β (both 0 where a pixel does not count) and q in DN, each (n_pixels,)."""
    a, beta, q = (np.empty(smooth_dn.size) for _ in range(3))
    _fill(pair, smooth_dn, where, typical, a, beta, q)
    return a, beta, q


@njit(cache=True, nogil=True, inline="always")
def shared(pair):  # type: ignore[no-untyped-def]
    """Return what the weights take of the exposures as a whole: n₁, n₂, ν₁, ν₂ and r."""
    one, two = pair.first, pair.second
    return one.n_frames, two.n_frames, one.n_free, two.n_free, pair.ratio


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def weights_of(means, smooth, counts, exposures, typical):  # type: ignore[no-untyped-def]
    """Return a, β and q of a pixel.

    Args:
        means: D̄₁ and D̄₂.
        smooth: q̃.
        counts: 1.0 or 0.0.
        exposures: As `shared` has them.
        typical: Of the sensor.
    """
    n1, n2, free1, free2, ratio = exposures
    own, other = ratio / (ratio - 1.0), 1.0 / (ratio - 1.0)
    lit = max(smooth, 0.0)
    v1 = typical.gain_dn_per_e * lit + typical.read_dn2
    v2 = ratio * typical.gain_dn_per_e * lit + typical.read_dn2
    u1, u2 = 2.0 / free1 * v1 * v1, 2.0 / free2 * v2 * v2
    one, two = n1 * v2, n2 * v1  # frames over variance, but for a factor
    above = one * (means[0] - typical.bias_dn) + two * (means[1] - typical.bias_dn)
    q = above / (one + ratio * two)
    near = min(max(q, lit / _FARTHEST), lit * _FARTHEST)
    a = counts * lit * lit / ((u1 + u2) * near) if lit > 0 else 0.0
    return a, counts / (own * own * u1 + other * other * u2), q


@njit(cache=True, nogil=True)
def _fill(pair, smooth, where, typical, a, beta, q):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    mean1, mean2, exposures = pair.first.mean, pair.second.mean, shared(pair)
    for i in range(len(smooth)):
        counts = 1.0 if where[i] else 0.0
        means = mean1[i], mean2[i]
        a[i], beta[i], q[i] = weights_of(means, smooth[i], counts, exposures, typical)
