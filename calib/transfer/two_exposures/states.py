"""Which pixels two exposures determine."""

from dataclasses import dataclass
from functools import cached_property

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


@dataclass(frozen=True)
class Told:
    """Puts NaN where a pixel's state does not allow a value; each mask is (n_pixels,)."""

    reason: NDArray[np.uint8]

    def always(self, values: Pixels) -> Pixels:
        """Return values that any pixel tells that neither clips nor is dead."""
        return np.where(self._nothing, np.nan, values)

    def with_gain(self, values: Pixels) -> Pixels:
        """Return values that need a response to light."""
        return np.where(self._no_gain, np.nan, values)

    def with_shot_noise(self, values: Pixels) -> Pixels:
        """Return values that are divided by the shot noise."""
        return np.where(self.reason != PixelState.VALID, np.nan, values)

    @cached_property
    def _nothing(self) -> NDArray[np.bool_]:
        first, last = PixelState.CLIPPED_AT_ZERO, PixelState.DEAD
        return np.greater_equal(self.reason, first) & np.less_equal(self.reason, last)

    @cached_property
    def _no_gain(self) -> NDArray[np.bool_]:
        return self._nothing | np.equal(self.reason, PixelState.NO_RESPONSE)
