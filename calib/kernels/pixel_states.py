"""Whether two exposures determine a pixel, and the values that its state allows."""

from typing import NamedTuple

import numpy as np
from numba import njit, uint8


class StateCodes(NamedTuple):
    """The codes of the states, and what a response and shot noise have to exceed, in their σ."""

    valid: int
    at_zero: int
    at_full_scale: int
    dead: int
    no_response: int
    no_shot_noise: int
    response_sigma: float
    shot_noise_sigma: float


@njit(cache=True, nogil=True, inline="always")
def state_of(d, v, spread, extremes, codes):  # type: ignore[no-untyped-def]
    """Return the gravest state that holds.

    Args:
        d: D.
        v: V.
        spread: Variances of D and of V.
        extremes: σ₁² + σ₂², and how many samples stood at code 0 and at the highest code.
        codes: The states' codes.
    """
    both, at_zero, at_full_scale = extremes
    state = codes.valid
    if not (v > 0 and v * v > codes.shot_noise_sigma**2 * spread[1]):
        state = codes.no_shot_noise
    if not (d > 0 and d * d > codes.response_sigma**2 * spread[0]):
        state = codes.no_response
    if both == 0:
        state = codes.dead
    if at_zero > 0:
        state = codes.at_zero
    if at_full_scale > 0:
        state = codes.at_full_scale
    return uint8(state)


@njit(cache=True, nogil=True, inline="always")
def masks_of(state, codes):  # type: ignore[no-untyped-def]
    """Return 0 or NaN, to be added: what any pixel tells, what needs a gain, what shot noise."""
    shot_noise = 0.0 if state == codes.valid else np.nan
    gain = 0.0 if state == codes.no_shot_noise else shot_noise
    always = 0.0 if state == codes.no_response else gain
    return always, gain, shot_noise
