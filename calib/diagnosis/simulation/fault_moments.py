"""What faults of codes do to single pixels, from the chance of each code: nothing is drawn.

Moments, and what stands out, are those that `calib.diagnosis.statistics.gather` finds in a
recording: samples beyond the cut about the median are left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

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
from calib.kernels.code_moments import Limits, code_moments

Floats = NDArray[np.float64]

LIMITS = Limits(
    cut=CUT_SIGMA,
    hardly=1e-5,
    # 0.7 of a cut is 3.5 standard deviations, beyond which chance has half of that share.
    near=0.3,
    near_share=1e-3,
    beside=BESIDE_SIGMA,
    far=FAR_SIGMA,
    flip=FLIP_SIGMA,
    very_far=VERY_FAR_SIGMA,
)
"""Those by which a recording's samples are told apart."""
KINDS = 2 + 2 * FLIPS
"""Kinds of samples that stand out: above, below, and bits that were raised and lowered."""
MOST_KEPT = 1 << 15
"""Chances of so many codes, of all nodes, are kept for the next faults; more are told anew."""


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


@dataclass(frozen=True)
class PixelCodes:
    """Pixels whose noise is a straight function of their means: which codes they give.

    Attributes:
        means: Of pixels before rounding and before any fault, DN, (n,).
        nodes: Means between which they lie, DN, (n_nodes,).
        spread: Noise there, without rounding's, DN, likewise.
        middle: By which the recording tells what stands out there, DN, likewise.
        apart: By how much pixels scatter about that, DN.
        top: The highest code.
    """

    means: Floats
    nodes: Floats
    spread: Floats
    middle: Floats
    apart: float
    top: int

    @classmethod
    def of(cls, means: Floats, variance: Floats, sigma: Floats, top: int) -> "PixelCodes":
        """Return those of pixels.

        Args:
            means: Of pixels before rounding and before any fault, DN, (n,).
            variance: Of each with rounding, DN^2, (n,).
            sigma: By which the recording tells what stands out of each, DN, (n,).
            top: The highest code.
        """
        nodes = nodes_between(means, np.sqrt(max(float(variance.min()), 1.0 / 12.0)))
        spread = np.sqrt(np.maximum(straight(means, variance, nodes) - 1.0 / 12.0, 1e-2))
        middle = about_nodes(nodes, means, sigma)
        apart = float((sigma - np.interp(means, nodes, middle)).std())
        return cls(means, nodes, spread, middle, apart, top)

    def moments(self, faults: Sequence[CodeFault]) -> PixelMoments:
        """Return the moments of the pixels behind `faults`, in the order in which they act."""
        nodes, spread, middle, apart = self.nodes, self.spread, self.middle, self.apart
        if not faults and is_gaussian(nodes, spread, self.top):
            return PixelMoments.gaussian(spread, nodes).at(nodes, self.means)
        codes, chance = stored_chances(*self._chances(), faults)
        # Pixels' cuts scatter as what they are told from: half of them are lower, half higher.
        found = _moments(codes, chance, middle)
        if not found.near.any() or apart < 0.01 * float(middle.min()):
            return found.at(nodes, self.means)
        low, high = (_moments(codes, chance, middle + way * apart) for way in (-1.0, 1.0))
        return low.and_as_many(high).at(nodes, self.means)

    def _chances(self) -> tuple[Floats, Floats]:
        """Return codes about each node and the chance of each, (n_nodes, n_codes), kept if few."""
        if not self._kept:
            found = code_chances(self.nodes, self.spread, self.top)
            if found[1].size > MOST_KEPT:
                return found
            self._kept.append(found)
        return self._kept[0]

    @cached_property
    def _kept(self) -> list[tuple[Floats, Floats]]:
        return []


def _between(values: Floats, nodes: Floats, places: Floats) -> Floats:
    if values.ndim == 1:
        return np.interp(places, nodes, values)
    found = np.zeros((len(places), values.shape[1]))
    for k in np.flatnonzero(values.any(axis=0)):
        found[:, k] = np.interp(places, nodes, values[:, k])
    return found


def _moments(codes: Floats, chance: Floats, sigma: Floats) -> PixelMoments:
    """Return the moments at nodes whose samples are told by `sigma`, DN, (n_nodes,)."""
    moments, far = code_moments(codes, chance, sigma, LIMITS, FLIPS)
    mean, squares, fourths, out, near, raised = moments.T
    return PixelMoments(mean, squares, fourths, out, near, raised, far)
