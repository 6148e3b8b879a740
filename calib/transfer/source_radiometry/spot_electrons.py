"""The photo-electrons of a spot of light on a dark ground, from exposures of t and 2 t.

Source: Yielding, Cain and Seal (2018), Equations 17 to 19, with sums over the spot in place of
pixels. Their K = (D2 - D1)^2 / (V2 - V1) per pixel is a ratio whose denominator is mostly noise at
100 frames: sums of it come out too high, see docs/photon-transfer/source-radiometry.md. Pooled over
a spot the denominator is known to a fraction of a percent.
"""

from dataclasses import dataclass
from math import hypot, sqrt
from typing import Any

import numpy as np

from calib.errors import InputError, NotDeterminedError
from calib.transfer.estimate import Estimate
from calib.transfer.source_radiometry.region_sums import Mask, RegionSums
from calib.transfer.two_exposures.exposure_pair import ExposurePair

_SEEN_SIGMA = 5.0


@dataclass(frozen=True)
class SpotElectrons:
    """What a spot holds.

    Attributes:
        system_gain: Pooled over the spot, DN/e-.
        photoelectrons: Of the whole spot in the first exposure; what the ground has is taken off.
        ground: Electrons of a pixel of the ground in the first exposure, e-.
        n_pixels: Of the spot.
    """

    system_gain: Estimate
    photoelectrons: Estimate
    ground: Estimate
    n_pixels: int

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return {
            "system_gain_dn_per_e": self.system_gain.answer(),
            "photoelectrons": self.photoelectrons.answer(),
            "ground_e": self.ground.answer(),
            "pixels": self.n_pixels,
        }


def spot_photoelectrons(pair: ExposurePair, *, spot: Mask, ground: Mask) -> SpotElectrons:
    """Return the photo-electrons that light made within `spot` during the first exposure.

    G = R / D with R = sum (V2 - V1) and D = sum (D2 - D1) over the spot; f = 1 / (r - 1), 1 for a
    doubled exposure. The charge is f (D - n_spot mean_ground (D2 - D1)) / G: the sum of
    (D1 - B) / G with the bias B = D1 - f (D2 - D1), in which offsets cancel pixel by pixel, less
    the ground's dark charge. A system gain that differs among pixels moves G by the square of its
    relative scatter, 1e-4 for 1 %. Noise is taken to be independent between pixels and frames.

    Args:
        pair: Moments of both exposures, from `two_exposure_moments(recording).pair`.
        spot: Pixels that take all of the spot's light in, (n_pixels,), a frame's row by row.
        ground: Pixels without light, likewise; none of the spot's.

    Raises:
        InputError: `bad-region`, `bad-exposures`.
        NotDeterminedError: `clipped`, or `no-light` where the spot does not stand out.
    """
    _check(pair, spot, ground)
    first_gain = pair.at(spot).ratio_of_sums
    lit, dark = (RegionSums.of(pair, region, first_gain) for region in (spot, ground))
    share = lit.n_pixels / dark.n_pixels
    light_dn, ground_var = lit.step_dn - share * dark.step_dn, share**2 * dark.step_variance
    _check_seen(lit, light_dn, lit.step_variance + ground_var)
    gain, per_step = lit.rise_dn2 / lit.step_dn, 1.0 / (pair.ratio - 1.0)
    charge, to_ground = per_step * light_dn / gain, per_step / (gain * dark.n_pixels)
    of_step = (pair.ratio_std * per_step) ** 2
    of_charge = lit.charge_relative_variance(light_dn, ground_var) + of_step
    ground_e, of_ground = to_ground * dark.step_dn, lit.gain_relative_variance + of_step
    ground_std = hypot(to_ground * sqrt(dark.step_variance), ground_e * sqrt(of_ground))
    return SpotElectrons(
        system_gain=Estimate(gain, gain * sqrt(lit.gain_relative_variance), "DN/e-"),
        photoelectrons=Estimate(charge, charge * sqrt(of_charge), "e-"),
        ground=Estimate(ground_e, ground_std, "e-"),
        n_pixels=lit.n_pixels,
    )


def _check_seen(lit: RegionSums, light_dn: float, light_variance: float) -> None:
    """Raise NotDeterminedError unless the spot's mean and variance rise beyond doubt."""
    mean_rises = light_dn > _SEEN_SIGMA * sqrt(light_variance) and lit.step_dn > 0
    if not (mean_rises and lit.rise_dn2 > _SEEN_SIGMA * sqrt(lit.rise_variance)):
        raise NotDeterminedError(
            f"the spot's mean or variance does not rise by {_SEEN_SIGMA:g} standard errors from "
            "the first exposure to the second: give more light, or more frames",
            code="no-light",
        )


def _check(pair: ExposurePair, spot: Mask, ground: Mask) -> None:
    for name, region in (("spot", spot), ("ground", ground)):
        if region.shape != (pair.n_pixels,) or region.dtype != np.bool_ or not region.any():
            raise InputError(
                f"the region {name} is {region.dtype} of shape {region.shape}: give a mask of "
                f"{pair.n_pixels} pixels, some of them True",
                code="bad-region",
            )
    if (spot & ground).any():
        raise InputError("spot and ground share pixels: part them", code="bad-region")
    if not pair.ratio > 1:
        raise InputError(
            f"the second exposure is {pair.ratio:g} times the first: give the longer one second",
            code="bad-exposures",
        )
    clipped = int(np.count_nonzero((spot | ground) & ~pair.unclipped))
    if clipped:
        raise NotDeterminedError(
            f"{clipped} pixels of spot and ground reach an end of the codes: shorten the "
            "exposures, or take those pixels out",
            code="clipped",
        )
