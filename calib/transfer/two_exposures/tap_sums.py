"""What pooled estimates need of the pixels, of one tap or of all, from one pass over them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.kernels.in_parts import in_parts
from calib.kernels.pooled_sums import ALL_TAPS, EVEN, WEIGHT, covariance_sums, weighted_sums
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.weights import Weights

Array = NDArray[np.float64]

_COVARIANCE_OF = 1 << 19  # pixels tell the errors to well under 1 %


@dataclass(frozen=True)
class TapSums:
    """Weighted sums of moments tap by tap; those of all taps are their sum.

    Attributes:
        pair: Both exposures.
        weights: What the weights are made of.
        tap: Which tap reads each pixel, from 0, (n_pixels,).
        by_tap: Rows and columns are named in `calib.kernels.pooled_sums`, (n_taps, 4, 9).
    """

    pair: ExposurePair
    weights: Weights
    tap: NDArray[np.uint8]
    by_tap: Array

    @classmethod
    def of(cls, pair: ExposurePair, weights: Weights, tap: NDArray[np.uint8]) -> "TapSums":
        """Add up all pixels."""
        n_taps = int(tap.max(initial=0)) + 1

        def part(some: slice) -> Array:
            of_part = weights.smooth_dn[some], weights.where[some], tap[some], weights.typical
            return weighted_sums(pair.arrays(0.0, some), *of_part, n_taps=n_taps)

        return cls(pair, weights, tap, sum(in_parts(pair.n_pixels, part), np.zeros((n_taps, 4, 9))))

    def over(self, of_tap: int) -> Array:
        """Return the sums over one tap, or over `ALL_TAPS`, (4, 9)."""
        return np.asarray(self.by_tap.sum(axis=0) if of_tap == ALL_TAPS else self.by_tap[of_tap])

    def n_usable(self, of_tap: int) -> int:
        """Return how many pixels count."""
        return int(self.over(of_tap)[EVEN, WEIGHT])

    def covariance(
        self, of_tap: int, common: tuple[tuple[float, float], tuple[float, float]]
    ) -> tuple[Array, Array]:
        """Return how far the sums scatter, and powers of the variances, by exposure.

        Args:
            of_tap: One tap, or `ALL_TAPS`.
            common: Of each exposure (a, b), a + bq² being in the variances in common.

        Returns:
            As `covariance_sums` has them.
        """
        pair, weights, gain = self.pair, self.weights, self.pair.ratio_of_sums
        every = -(-pair.n_pixels // _COVARIANCE_OF)

        def part(some: slice) -> tuple[Array, Array]:
            of_part = weights.smooth_dn[some], weights.where[some], self.tap[some], weights.typical
            return covariance_sums(
                pair.arrays(gain, some), *of_part, of_tap=of_tap, common=common, every=every
            )

        covariance, powers = zip(*in_parts(pair.n_pixels, part), strict=True)
        return np.sum(covariance, axis=0), np.sum(powers, axis=0)
