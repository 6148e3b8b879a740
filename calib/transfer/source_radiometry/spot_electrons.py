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
from calib.recording.block_statistics import BlockStatistics
from calib.transfer.estimate import Estimate
from calib.transfer.source_radiometry.region_sums import Mask, RegionSums
from calib.transfer.source_radiometry.sum_noise import SumNoise

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


def spot_photoelectrons(
    first: BlockStatistics, second: BlockStatistics, *, spot: Mask, ground: Mask
) -> SpotElectrons:
    """Return the photo-electrons that light made within `spot` during the first exposure.

    G = R / D with R = sum (V2 - V1) and D = sum (D2 - D1) over the spot; f = t1 / (t2 - t1), 1 for
    a doubled exposure. The charge is f (D - n_spot mean_ground (D2 - D1)) / G: the sum of
    (D1 - B) / G with the bias B = D1 - f (D2 - D1), in which offsets cancel pixel by pixel, less
    the ground's dark charge. A system gain that differs among pixels moves G by the square of its
    relative scatter, 1e-4 for 1 %. Noise is taken to be independent between pixels and frames.

    Args:
        first: Statistics of the shorter exposure; three frames or more.
        second: Of the longer one, of the same scene.
        spot: Pixels that take all of the spot's light in, (n_pixels,), flat as the statistics are.
        ground: Pixels without light, likewise; none of the spot's.

    Raises:
        InputError: `bad-region`, `bad-exposures`, `too-few-frames`.
        NotDeterminedError: `clipped`, or `no-light` where the spot does not stand out.
    """
    _check_regions(first, spot, ground)
    _check_blocks(first, second, spot | ground)
    lit, dark = (RegionSums.of(first, second, region) for region in (spot, ground))
    if lit.step_dn <= 0:
        raise _no_light()
    noise, dark_noise = (SumNoise.of(first, second, region, lit) for region in (spot, ground))
    share = lit.n_pixels / dark.n_pixels
    light_dn, ground_var = lit.step_dn - share * dark.step_dn, share**2 * dark_noise.step
    seen = light_dn / sqrt(noise.step + ground_var), lit.rise_dn2 / sqrt(noise.rise)
    if min(seen) < _SEEN_SIGMA:
        raise _no_light()
    gain, gain_relative = lit.gain, sqrt(noise.of_gain(lit))
    charge = lit.per_step * light_dn / gain
    charge_std = charge * sqrt(noise.of_charge(lit, light_dn, ground_var))
    dn_to_ground = lit.per_step / (gain * dark.n_pixels)
    ground_e = dn_to_ground * dark.step_dn
    ground_std = hypot(dn_to_ground * sqrt(dark_noise.step), ground_e * gain_relative)
    return SpotElectrons(
        system_gain=Estimate(gain, gain * gain_relative, "DN/e-"),
        photoelectrons=Estimate(charge, charge_std, "e-"),
        ground=Estimate(ground_e, ground_std, "e-"),
        n_pixels=lit.n_pixels,
    )


def _no_light() -> NotDeterminedError:
    return NotDeterminedError(
        f"the spot's mean or variance does not rise by {_SEEN_SIGMA:g} standard errors from the "
        "first exposure to the second: give more light, or more frames",
        code="no-light",
    )


def _check_regions(first: BlockStatistics, spot: Mask, ground: Mask) -> None:
    shape = first.mean_dn.shape
    for name, region in (("spot", spot), ("ground", ground)):
        if region.shape != shape or region.dtype != np.bool_ or not region.any():
            raise InputError(
                f"the region {name} is {region.dtype} of shape {region.shape}: give a mask of "
                f"{shape[0]} pixels, some of them True",
                code="bad-region",
            )
    if (spot & ground).any():
        raise InputError("spot and ground share pixels: part them", code="bad-region")


def _check_blocks(first: BlockStatistics, second: BlockStatistics, used: Mask) -> None:
    t1, t2 = first.block.exposure_us, second.block.exposure_us
    if not t2 > t1 or second.mean_dn.shape != first.mean_dn.shape:
        raise InputError(
            f"the exposures are {t1:g} and {t2:g} us: give the shorter one first, then the longer "
            "one of the same camera",
            code="bad-exposures",
        )
    if min(first.n_lines, second.n_lines) < 3:
        raise InputError(
            f"{first.n_lines} and {second.n_lines} frames: give 3 or more of each exposure",
            code="too-few-frames",
        )
    for block in (first, second):
        clipped = (block.n_at_zero + block.n_at_full_scale)[used] > 0
        if clipped.any():
            raise NotDeterminedError(
                f"block {block.block.block}: {int(clipped.sum())} pixels of spot and ground reach "
                "an end of the codes: shorten the exposures, or take those pixels out",
                code="clipped",
            )
