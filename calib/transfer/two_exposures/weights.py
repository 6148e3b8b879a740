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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.kernels.neighbour_means import neighbour_means
from calib.kernels.pixel_sums import Pixels
from calib.kernels.pixel_weights import Typical, pixel_weights
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import ROUNDING_DN2

_NEIGHBOURS = {1: 65, 2: 9}  # along an axis, by the number of axes
_TYPICAL_OF = 1 << 18  # pixels are enough for what is typical


@dataclass(frozen=True)
class Weights:
    """What the weights are made of; they themselves are made where they are summed.

    Attributes:
        smooth_dn: q̃ of the first exposure, DN, (n_pixels,).
        where: The pixels that count, (n_pixels,).
        typical: Gain, read noise and bias of the whole sensor.
    """

    smooth_dn: Pixels
    where: NDArray[np.bool_]
    typical: Typical


def weights(pair: ExposurePair, where: NDArray[np.bool_], shape: tuple[int, ...]) -> Weights:
    """Return the weights of the pixels `where`, (n_pixels,), of an image of `shape`."""
    means = pair.first.mean_dn, pair.second.mean_dn
    smooth = neighbour_means(*means, where, shape, _NEIGHBOURS[len(shape)])
    smooth /= pair.ratio - 1.0
    some = slice(None, None, -(-pair.n_pixels // _TYPICAL_OF))
    typical = _typical(pair.at(some), where[some], smooth[some], pair.ratio_of_sums)
    return Weights(smooth, where, typical)


def _typical(
    pair: ExposurePair, where: NDArray[np.bool_], smooth_dn: Pixels, gain_dn_per_e: float
) -> Typical:
    """Return what is typical of these pixels; of rounding alone where none counts."""
    if not where.any():
        return Typical(gain_dn_per_e, ROUNDING_DN2, 0.0)
    rho = pair.ratio - 1.0
    bias = pair.first.mean_dn - pair.difference_dn / rho
    read = pair.first.variance_dn2 - pair.variance_difference_dn2 / rho
    # Rather too much read noise first: it only spreads the weights by which it is then measured.
    much = float(np.percentile(pair.first.variance_dn2[where], 5.0))
    first = Typical(gain_dn_per_e, max(much, ROUNDING_DN2), 0.0)
    arrays = pair.arrays(gain_dn_per_e)
    _, by_read, _ = pixel_weights(
        arrays, np.ascontiguousarray(smooth_dn), np.ascontiguousarray(where), first
    )
    read_dn2 = max(float(np.average(read, weights=by_read)), ROUNDING_DN2)
    return Typical(gain_dn_per_e, read_dn2, float(np.mean(bias[where])))
