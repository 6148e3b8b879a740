"""Which pixels two exposures determine."""

import numpy as np
from numpy.typing import NDArray

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_state import (
    RESPONSE_SIGMA,
    SHOT_NOISE_SIGMA,
    PixelState,
)


def pixel_states(
    pair: ExposurePair, difference_std: Pixels, variance_difference_std: Pixels
) -> NDArray[np.uint8]:
    """Return each pixel's `PixelState`, the gravest that holds, (n_pixels,)."""
    first, second = pair.first, pair.second
    v1, v2 = first.variance_dn2, second.variance_dn2
    shot_noise = pair.variance_difference_dn2 > SHOT_NOISE_SIGMA * variance_difference_std
    response = pair.difference_dn > RESPONSE_SIGMA * difference_std
    return np.select(
        [
            first.at_full_scale + second.at_full_scale > 0,
            first.at_zero + second.at_zero > 0,
            (v1 == 0) & (v2 == 0),
            ~response,
            ~shot_noise,
        ],
        [
            np.uint8(PixelState.CLIPPED_AT_FULL_SCALE),
            np.uint8(PixelState.CLIPPED_AT_ZERO),
            np.uint8(PixelState.DEAD),
            np.uint8(PixelState.NO_RESPONSE),
            np.uint8(PixelState.NO_SHOT_NOISE),
        ],
        np.uint8(PixelState.VALID),
    )


def told(reason: NDArray[np.uint8], values: Pixels, *unless: PixelState) -> Pixels:
    """Return `values`, NaN where clipped, dead, or in one of the states of `unless`."""
    never = (PixelState.CLIPPED_AT_ZERO, PixelState.CLIPPED_AT_FULL_SCALE, PixelState.DEAD)
    return np.where(np.isin(reason, (*never, *unless)), np.nan, values)
