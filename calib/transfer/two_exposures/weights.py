"""Weights of pixels in pooled estimates that know nothing of the pixel's own variance.

A weight from a pixel's own variance goes with its error: pixels that are noisy by chance would
count less, and G would come out low. These are made from

- q̃, the signal smoothed over neighbours: illumination, without the pixel's own gain;
- q, the pixel's own signal from the mean of D̄₁ and D̄₂ that is not correlated with D̄₂ − D̄₁;
- one read noise and one gain for the whole sensor.

The gain is Σ aV / Σ aD with a = h/q. Since D = (r−1)·q and V = (r−1)·G·q, it is the mean of the
pixels' own gains, weighted with h = q̃²/var(V), the best that one gain could have. Σ V/Σ D instead
is their mean weighted with the signal G·λ: where gains differ by c (relative) among pixels alike
lit, it is 1 + c² times their mean, and electrons that are reckoned with it are 1 + c² too few.
"""

from collections import deque
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.in_parts import in_parts
from calib.transfer.two_exposures.sanuc import ROUNDING_DN2

_NEIGHBOURS = {1: 65, 2: 9}  # along an axis, by the number of axes
_TYPICAL_OF = 1 << 18  # pixels are enough for what is typical
_FARTHEST = 4.0  # a pixel's signal from its neighbours', as a factor


@dataclass(frozen=True)
class Weights:
    """Not normalised, each (n_pixels,), 0 where a pixel does not count.

    Attributes:
        gain: a, of V and D in the gain.
        read: Of the read noise variance.
        even: 1 for all pixels that count, of bias and photo-electrons.
        signal_dn: q of the first exposure, DN.
    """

    gain: Pixels
    read: Pixels
    even: Pixels
    signal_dn: Pixels

    def of(self, members: NDArray[np.bool_]) -> "Weights":
        """Return the weights of these pixels alone."""
        gain, read, even = (w * members for w in (self.gain, self.read, self.even))
        return Weights(gain, read, even, self.signal_dn)


@dataclass(frozen=True)
class _Typical:
    """One gain, read noise and bias for all pixels."""

    gain_dn_per_e: float
    read_dn2: float
    bias_dn: float

    def variances(self, pair: ExposurePair, smooth_dn: Pixels) -> tuple[Pixels, Pixels]:
        """Return σ₁² and σ₂² of pixels of the signal q̃."""
        shot = self.gain_dn_per_e * np.maximum(smooth_dn, 0.0)
        return shot + self.read_dn2, pair.ratio * shot + self.read_dn2


def weights(pair: ExposurePair, where: NDArray[np.bool_], shape: tuple[int, ...]) -> Weights:
    """Return the weights of the pixels `where`, (n_pixels,), of an image of `shape`."""
    smooth = _smoothed(pair.difference_dn / (pair.ratio - 1.0), where, shape)
    some = slice(None, None, -(-pair.n_pixels // _TYPICAL_OF))
    typical = _typical(pair.at(some), where[some], smooth[some], pair.ratio_of_sums)
    found = Weights(*(np.empty(pair.n_pixels) for _ in range(4)))

    def fill(part: slice) -> None:
        of_part = _weights(pair.at(part), where[part], smooth[part], typical)
        for field in fields(Weights):
            getattr(found, field.name)[part] = getattr(of_part, field.name)

    deque(in_parts(pair.n_pixels, fill), maxlen=0)
    return found


def _typical(
    pair: ExposurePair, where: NDArray[np.bool_], smooth_dn: Pixels, gain_dn_per_e: float
) -> _Typical:
    """Return what is typical of these pixels; of rounding alone where none counts."""
    if not where.any():
        return _Typical(gain_dn_per_e, ROUNDING_DN2, 0.0)
    rho = pair.ratio - 1.0
    bias = pair.first.mean_dn - pair.difference_dn / rho
    read = pair.first.variance_dn2 - pair.variance_difference_dn2 / rho
    # Rather too much read noise first: it only spreads the weights by which it is then measured.
    much = float(np.percentile(pair.first.variance_dn2[where], 5.0))
    first = _Typical(gain_dn_per_e, max(much, ROUNDING_DN2), 0.0)
    by_read = where / _variance_of_read(pair, first.variances(pair, smooth_dn))
    read_dn2 = max(float(np.average(read, weights=by_read)), ROUNDING_DN2)
    return _Typical(gain_dn_per_e, read_dn2, float(np.mean(bias[where])))


def _weights(
    pair: ExposurePair, where: NDArray[np.bool_], smooth_dn: Pixels, typical: _Typical
) -> Weights:
    variances = typical.variances(pair, smooth_dn)
    one, two = _sampled(pair, variances)
    signal = _own_signal(pair, variances, typical.bias_dn)
    lit = np.where(where, np.maximum(smooth_dn, 0.0), 0.0)
    near = np.clip(signal, lit / _FARTHEST, lit * _FARTHEST)
    best = lit**2 / (one + two)
    return Weights(
        gain=np.divide(best, near, where=lit > 0, out=np.zeros_like(best)),
        read=where / _variance_of_read(pair, variances),
        even=where.astype(np.float64),
        signal_dn=signal,
    )


def _sampled(pair: ExposurePair, variances: tuple[Pixels, Pixels]) -> tuple[Pixels, Pixels]:
    """Return the variances of k₂ of both exposures, for Gaussian noise, DN⁴."""
    one, two = variances
    return 2.0 * one**2 / pair.first.n_free, 2.0 * two**2 / pair.second.n_free


def _variance_of_read(pair: ExposurePair, variances: tuple[Pixels, Pixels]) -> Pixels:
    """Return the variance of σ₁² − V/ρ, DN⁴."""
    rho = pair.ratio - 1.0
    one, two = _sampled(pair, variances)
    return np.asarray((1.0 + 1.0 / rho) ** 2 * one + two / rho**2)


def _own_signal(pair: ExposurePair, variances: tuple[Pixels, Pixels], bias_dn: float) -> Pixels:
    """Return q: from the mean of both exposures whose error does not go with their difference."""
    one, two = pair.first.n_frames / variances[0], pair.second.n_frames / variances[1]
    mean = (one * pair.first.mean_dn + two * pair.second.mean_dn) / (one + two)
    return np.asarray((mean - bias_dn) * (one + two) / (one + pair.ratio * two))


def _smoothed(signal: Pixels, where: NDArray[np.bool_], shape: tuple[int, ...]) -> Pixels:
    """Return the mean over the neighbours that count, (n_pixels,)."""
    size = _NEIGHBOURS[len(shape)]
    total = uniform_filter(
        np.where(where, signal, 0.0).reshape(shape), size, mode="nearest"
    ).ravel()
    share = uniform_filter(where.reshape(shape).astype(np.float64), size, mode="nearest").ravel()
    return np.asarray(total / np.maximum(share, 0.5 / size ** len(shape)))
