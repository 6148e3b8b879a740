"""What faults of codes do to single pixels, from the chance of each code: nothing is drawn.

Moments, and what stands out, are those that `calib.diagnosis.statistics.gather` finds in a
recording: samples beyond the cut about the median are left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.simulation.fault_chances import (
    about_nodes,
    code_chances,
    is_gaussian,
    nodes_between,
    stored_chances,
    straight,
)
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.rare import (
    BESIDE_SIGMA,
    FAR_SIGMA,
    FLIP_SIGMA,
    FLIPS,
    VERY_FAR_SIGMA,
)
from calib.forward.code_fault import CodeFault

Floats = NDArray[np.float64]

HARDLY = 1e-5
"""Where less than this share is beyond the cut about the mean, no median is asked for."""
NEAR_CUT = 0.3
"""By this part of it a pixel's own cut may be off."""
NEAR_SHARE = 1e-3
"""Of the samples; 0.7 of a cut is 3.5 standard deviations, beyond which chance has half of that."""
KINDS = 2 + 2 * FLIPS
"""Kinds of samples that stand out: above, below, and bits that were raised and lowered."""


@dataclass(frozen=True)
class PixelMoments:
    """Of pixels, or of nodes between which they lie.

    Attributes:
        mean: Of the samples within the cut, DN, (n,).
        squares: Of their deviations from it, over all samples, DN^2, (n,).
        fourths: Likewise, DN^4.
        out: Share of the samples beyond the cut, (n,).
        near: Whether some of them lie near the cut, 1 or 0, (n,).
        raised: Share of those by which a neighbour would be part of a track, (n,).
        far: Share of those that are counted, by kind, (n, KINDS).
    """

    mean: Floats
    squares: Floats
    fourths: Floats
    out: Floats
    near: Floats
    raised: Floats
    far: Floats

    @classmethod
    def gaussian(cls, spread: Floats, nodes: Floats) -> "PixelMoments":
        """Return those of noise of `spread`, DN, about `nodes`, and of rounding's 1/12."""
        square, none = spread**2, np.zeros_like(spread)
        fourth = 3.0 * square**2 + square / 2.0 + 1.0 / 80.0
        far = np.zeros((len(spread), KINDS))
        return cls(nodes, square + 1.0 / 12.0, fourth, none, none, none, far)

    def and_as_many(self, other: "PixelMoments") -> "PixelMoments":
        """Return those of as many samples of either kind."""
        names = [each.name for each in fields(self)]
        return PixelMoments(*(0.5 * (getattr(self, n) + getattr(other, n)) for n in names))

    def at(self, nodes: Floats, places: Floats) -> "PixelMoments":
        """Return those of `places` between `nodes`, (n,), both means before the fault, DN."""
        offset = self.mean - nodes
        found = {
            each.name: _between(getattr(self, each.name), nodes, places) for each in fields(self)
        }
        return PixelMoments(**{**found, "mean": places + np.interp(places, nodes, offset)})


def pixel_moments(
    means: Floats, variance: Floats, sigma: Floats, faults: Sequence[CodeFault], top: int
) -> PixelMoments:
    """Return the moments of pixels whose noise is a straight function of their means.

    Args:
        means: Of pixels before rounding and before any fault, DN, (n,).
        variance: Of each with rounding, DN^2, (n,).
        sigma: By which the recording tells what stands out of each, DN, (n,).
        faults: In the order in which they act.
        top: The highest code.
    """
    nodes = nodes_between(means, np.sqrt(max(float(variance.min()), 1.0 / 12.0)))
    spread = np.sqrt(np.maximum(straight(means, variance, nodes) - 1.0 / 12.0, 1e-2))
    if not faults and is_gaussian(nodes, spread, top):
        return PixelMoments.gaussian(spread, nodes).at(nodes, means)
    codes, chance = stored_chances(*code_chances(nodes, spread, top), faults)
    middle = about_nodes(nodes, means, sigma)
    # Pixels' cuts scatter as what they are told from: half of them are lower, half higher.
    apart = float((sigma - np.interp(means, nodes, middle)).std())
    found = _moments(codes, chance, middle)
    if not found.near.any() or apart < 0.01 * float(middle.min()):
        return found.at(nodes, means)
    low, high = (_moments(codes, chance, middle + way * apart) for way in (-1.0, 1.0))
    return low.and_as_many(high).at(nodes, means)


def _between(values: Floats, nodes: Floats, places: Floats) -> Floats:
    if values.ndim == 1:
        return np.interp(places, nodes, values)
    found = np.zeros((len(places), values.shape[1]))
    for k in np.flatnonzero(values.any(axis=0)):
        found[:, k] = np.interp(places, nodes, values[:, k])
    return found


def _moments(codes: Floats, chance: Floats, sigma: Floats) -> PixelMoments:
    """Return the moments at nodes whose samples are told by `sigma`, DN, (n_nodes,)."""
    sigma = sigma[:, None]
    cut = CUT_SIGMA * sigma + 1.0
    mean = np.asarray((chance * codes).sum(axis=1), np.float64)
    jumps = (chance * (np.abs(codes - mean[:, None]) > cut)).sum(axis=1) > HARDLY
    if jumps.any():
        mean = np.where(jumps, _settled(codes, chance, cut), mean)
    off = codes - mean[:, None]
    out = np.abs(off) > cut
    within = np.where(out, 0.0, chance)
    square = off**2
    return PixelMoments(
        # Where samples lie near the cut, those about the first mean have another than those
        # about the median.
        mean + (within * off).sum(axis=1),
        (within * square).sum(axis=1),
        (within * square**2).sum(axis=1),
        (chance * out).sum(axis=1),
        ((chance * (np.abs(np.abs(off) / cut - 1.0) < NEAR_CUT)).sum(axis=1) > NEAR_SHARE) * 1.0,
        (chance * (off > BESIDE_SIGMA * sigma)).sum(axis=1),
        _far(off, np.where(out & (np.abs(off) > FAR_SIGMA * sigma), chance, 0.0), sigma),
    )


def _settled(codes: Floats, chance: Floats, cut: Floats) -> Floats:
    """Return the mean of what lies within the cut about the median, (n_nodes,)."""
    order = np.argsort(codes, axis=1)
    upto = np.cumsum(np.take_along_axis(chance, order, axis=1), axis=1)
    middle = np.argmax(upto >= 0.5 * upto[:, -1:], axis=1)[:, None]
    median = np.take_along_axis(codes, np.take_along_axis(order, middle, axis=1), axis=1)
    near = np.where(np.abs(codes - median) <= cut, chance, 0.0)
    return np.asarray((near * codes).sum(axis=1) / np.maximum(near.sum(axis=1), 1e-12))


def _far(off: Floats, chance: Floats, sigma: Floats) -> Floats:
    """Return the share of samples that are counted by kind, (n_nodes, KINDS)."""
    node, k = np.nonzero(chance)
    off, share, sigma = off[node, k], chance[node, k], sigma[node, 0]
    size = np.maximum(np.abs(off), 1.0)
    bit = np.clip(np.rint(np.log2(size)), 0, FLIPS - 1).astype(np.intp)
    flipped = (np.abs(size - np.exp2(bit)) < FLIP_SIGMA * sigma) & (size > VERY_FAR_SIGMA * sigma)
    kind = np.where(off > 0.0, 0, 1)
    kind = np.where(flipped, 2 + bit + np.where(off > 0.0, 0, FLIPS), kind)
    found = np.bincount(node * KINDS + kind, share, minlength=len(chance) * KINDS)
    return np.asarray(found.reshape(-1, KINDS), np.float64)
