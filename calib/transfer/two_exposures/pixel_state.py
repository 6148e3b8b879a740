"""Why two exposures do, or do not, determine a pixel."""

from enum import IntEnum

from calib.kernels.pixel_states import StateCodes

RESPONSE_SIGMA = 3.0
"""D₂ − D₁ has to exceed so many of its standard uncertainties: the gain is divided by it."""
SHOT_NOISE_SIGMA = 1.0
"""σ₂² − σ₁² has to exceed so many: the photo-electrons are divided by it."""


class PixelState(IntEnum):
    """The reason code of a pixel; a value that the state does not allow is NaN in the maps."""

    VALID = 0
    CLIPPED_AT_ZERO = 1
    """A sample stood at code 0: mean and variance are not those of the signal. Nothing is told."""
    CLIPPED_AT_FULL_SCALE = 2
    """A sample stood at the highest code. Nothing is told."""
    DEAD = 3
    """Sends one code in every frame of both exposures. Nothing is told."""
    NO_RESPONSE = 4
    """D₂ ≤ D₁ within their noise. No gain and no photo-electrons; SANUC still tells the rest."""
    NO_SHOT_NOISE = 5
    """σ₂² ≤ σ₁² within their noise, or not above it: the ratio that the photo-electrons are has
    no usable error. The gain is told (it may be negative); photo-electrons are not; of bias and
    read noise SANUC tells both, S3NUC, which divides by the gain, neither."""


STATE_CODES = StateCodes(
    valid=int(PixelState.VALID),
    at_zero=int(PixelState.CLIPPED_AT_ZERO),
    at_full_scale=int(PixelState.CLIPPED_AT_FULL_SCALE),
    dead=int(PixelState.DEAD),
    no_response=int(PixelState.NO_RESPONSE),
    no_shot_noise=int(PixelState.NO_SHOT_NOISE),
    response_sigma=RESPONSE_SIGMA,
    shot_noise_sigma=SHOT_NOISE_SIGMA,
)
"""What the compiled loops are told of it."""
