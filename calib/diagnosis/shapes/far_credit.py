"""What heavy tails and tracks of charge are credited with beyond what sums of counts show of them.

Counts of what is far out are summed and whitened so that fits are linear; a handful of samples
where chance makes none is worth far more than their number. What the samples themselves say, less
what the sums do, is a credit of the name. Both names are credited with what either explains, so
together they are charged what they share. Where bits that flip explain the samples better, names
are credited with what they explain beside those. Readings that only rise are tails, too, unlike the
tracks in that nothing is beside them and that they follow no exposure.
"""

from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_events import FarEvents, far_events
from calib.diagnosis.shapes.far_likelihood import (
    flipped,
    hit,
    most_likely,
    raised,
    tailed,
)
from calib.diagnosis.statistics.rare import SINGLE

Floats = NDArray[np.float64]
Cause = tuple[Floats, float]

TAIL_NOISES = (6.0, 15.0)
"""Standard deviations of the noisier readings that are tried, over the read noise."""
CHARGE_NOISES = (4.0, 12.0, 40.0, 150.0, 600.0)
"""Mean charges that a pixel is left by a track, likewise."""
MOST = 100.0
"""Deviance that both are credited with at the most, and the likelier one beyond the other."""
LEFT = 0.1
"""Of what one explains, so much may be left, since its law may be another one: Laplace's."""
SURELY = 16.0
"""So much more have bits that flip to explain: two samples are a power of two off by chance."""
EVERY_NOISE = 3
"""Sums of each kind of single sample: blocks are told apart by their noise."""


@dataclass(frozen=True)
class FarCredit:
    """Deviance beyond that of sums.

    Attributes:
        tails: Of heavy tails.
        rays: Of tracks of charge.
        shared: What the two are credited with twice.
    """

    tails: float
    rays: float
    shared: float


def far_credit(evidence: Evidence) -> FarCredit:
    """Return what the samples far out say of both names."""
    events = far_events(evidence)
    if len(events.off_dn) == 0:
        return FarCredit(0.0, 0.0, 0.0)
    of_tails_tried = [each(events, evidence, x) for each in (tailed, raised) for x in TAIL_NOISES]
    tails, tails_alone = _best(of_tails_tried, [])
    rays, rays_alone = _best([hit(events, evidence, x) for x in CHARGE_NOISES], [])
    beside = _flips(events, evidence, max(tails_alone, rays_alone))
    of_tails, of_rays, both = (
        _beyond(causes, beside) for causes in ([tails], [rays], [tails, rays])
    )
    sums = evidence.rare_space.whitened(evidence.rare_space.seen) ** 2
    above, below, tracks = sums[: len(SINGLE) * EVERY_NOISE].reshape(len(SINGLE), -1).sum(axis=1)
    tried = [2.0 * log(len(each)) for each in (of_tails_tried, CHARGE_NOISES)]
    of_tails = _credited(of_tails - tried[0], above + below)
    of_rays = _credited(of_rays - tried[1], above + tracks)
    both = max(_credited(both - sum(tried), above + below + tracks), of_tails, of_rays)
    # What one explains beside the other, and beside what the other's shape leaves.
    tails_too, rays_too = (both - (1.0 + LEFT) * each for each in (of_rays, of_tails))
    least = min(of_tails, of_rays, MOST)
    apart = of_tails - of_rays
    of_tails = least + min(max(apart, 0.0), MOST)
    of_rays = least + min(max(-apart, 0.0), MOST)
    shared = max(of_tails - tails_too, of_rays - rays_too, 0.0)
    return FarCredit(of_tails, of_rays, min(shared, of_tails, of_rays))


def _credited(deviance: float, of_sums: float) -> float:
    """Return what is beyond the sums'; nothing where these have nothing to take a strength from."""
    return max(deviance - of_sums, 0.0) if of_sums > 0 else 0.0


def _best(causes: list[Cause], beside: list[Cause]) -> tuple[Cause, float]:
    """Return the likeliest of `causes`, and its deviance beside others."""
    found = [_beyond([cause], beside) for cause in causes]
    k = int(np.argmax(found))
    return causes[k], found[k]


def _flips(events: FarEvents, evidence: Evidence, least: float) -> list[Cause]:
    """Return bits that flip, if they explain far more than `least`."""
    any_bit, *each = flipped(events, evidence)
    one, alone = _best(each, [])
    _, of_any = _best([any_bit], [])
    alone -= 2.0 * log(len(each))
    if max(alone, of_any) <= least + SURELY:
        return []
    return [one, any_bit]


def _beyond(causes: list[Cause], beside: list[Cause]) -> float:
    return _deviance([*causes, *beside]) - _deviance(beside)


def _deviance(causes: list[Cause]) -> float:
    if not causes:
        return 0.0
    return most_likely(
        np.stack([ratio for ratio, _ in causes]), np.array([expected for _, expected in causes])
    )
