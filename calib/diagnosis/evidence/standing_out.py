"""Pixels that stand out of all others: by what their samples or their means miss."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.evidence.mean_space import MeanSpace
from calib.diagnosis.evidence.rare_space import whitened_counts
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.few_samples import excess_as_normal
from calib.diagnosis.statistics.noisy import beyond

Floats = NDArray[np.float64]

NEAR_SIGMA, FAR_SIGMA = 5.0, 12.0
"""Pixels between these and beyond are counted, of their variances and of their means' misfit."""
N_STEPS = 3


def excess_variance(sums: Sequence[BlockSums], baseline: Baseline, counts: Counts) -> Floats:
    """Return each pixel's variance over the expected one in all blocks, less 1, (n_pixels,)."""
    squares = np.zeros(sums[0].products.squares.size)
    for b, each in enumerate(sums):
        squares += (each.products.squares / baseline.variance_dn2[b]).ravel()
    lines = np.array([each.n_lines for each in sums], np.float64)
    freedom = (lines - 1).sum() * (1.0 - 1.0 / counts.smallest_tap)
    return excess_as_normal(squares / freedom, float(freedom))


def steps(z: Floats) -> Floats:
    """Return how many pixels stand out of all others: what all do is in the means."""
    if not z.any():
        return np.zeros(N_STEPS)
    z = beyond(z, z)
    far = z > FAR_SIGMA
    kinds = ((z > NEAR_SIGMA) & ~far, far, z < -NEAR_SIGMA)
    return whitened_counts(np.array([kind.sum() for kind in kinds], np.float64))


def held_slopes(slopes: Floats, counts: Floats, moved: Floats, about: Floats) -> Floats:
    """Return slopes of what `steps` gives, none steeper than from no effect to the whole of it.

    A count jumps where one pixel passes a limit. Over the tenth of an effect by which a derivative
    is taken, that one pixel would be a slope ten times as steep as all of them together have.

    Args:
        slopes: By how much of `moved` is added, (N_STEPS,).
        counts: What steps gives, at `about` or a little farther on, whichever is more, likewise.
        moved: By how much each pixel stands out more, standard deviations, (n_pixels,).
        about: By how much it stands out, likewise.
    """
    whole = float(np.linalg.norm(about))
    if whole == 0.0:
        return slopes
    most = np.abs(counts) * float(np.linalg.norm(moved)) / whole
    return np.asarray(np.clip(slopes, -most, most))


@dataclass(frozen=True)
class PixelMisfits:
    """By how much pixels' means miss the baseline.

    What grows with the exposure is no misfit: it has a place of its own.

    Attributes:
        space: Of the means.
        growth: What grows with the exposure, projected, (n_blocks, n_pixels).
        length2: Its squared length, (n_pixels,); 1 where the baseline absorbs it.
        told: Where it does not, likewise.
        used: How many means of each pixel tell a misfit, likewise.
    """

    space: MeanSpace
    growth: Floats
    length2: Floats
    told: NDArray[np.bool_]
    used: NDArray[np.intp]

    @classmethod
    def of(cls, space: MeanSpace, exposure_us: Floats) -> "PixelMisfits":
        """Return what is worked out once of all blocks' exposures, (n_blocks,)."""
        each = np.broadcast_to(exposure_us[:, None], space.weight.shape)
        growth = space.project(each)
        length2 = np.einsum("bp,bp->p", growth, growth)
        whole = (space.weight**2 * each**2).sum(axis=0)
        told = length2 > 1e-6 * np.maximum(whole, 1e-300)
        used = np.maximum((space.weight > 0).sum(axis=0) - len(space.basis) - told, 1)
        return cls(space, growth, np.where(told, length2, 1.0), told, used)

    def sigma(self, means: Floats, *, observed: bool) -> Floats:
        """Return by how many standard deviations each pixel's `means`, DN, miss, (n_pixels,).

        Of means without noise it is what they give on average with it: both stand on one scale,
        Wilson and Hilferty's, on which chi-squared is a standard normal number.
        """
        white = self.space.project(means)
        along = np.where(self.told, np.einsum("bp,bp->p", self.growth, white), 0.0)
        square = np.einsum("bp,bp->p", white, white) - along**2 / self.length2
        spread = 2.0 / (9.0 * self.used)
        middle = 1.0 - spread if observed else 1.0
        ratio = np.maximum(square, 0.0) / self.used + (0.0 if observed else 1.0)
        return np.asarray((np.cbrt(ratio) - middle) / np.sqrt(spread))
