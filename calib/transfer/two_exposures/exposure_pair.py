"""The moments of every pixel at two exposures of one scene."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.kernels.central_moments import central_moments
from calib.kernels.exposure_arrays import ExposureArrays, PairArrays
from calib.kernels.pixel_moments import PixelAccumulator
from calib.kernels.pixel_sums import Moments, Pixels, PixelSums
from calib.kernels.unclipped_sums import UnclippedSums, unclipped_sums

EVERY = slice(None)


@dataclass(frozen=True)
class ExposureMoments:
    """Unbiased moments of all blocks at one exposure, each about its own block's mean.

    Attributes:
        n_frames: Frames of all blocks.
        n_free: Degrees of freedom of the variance, frames less blocks.
        mean_dn: (n_pixels,).
        variance_dn2: k₂, (n_pixels,); rounding's 1/12 DN² is in it.
        third_dn3: k₃, (n_pixels,).
        at_zero: How many samples stood at code 0, (n_pixels,).
        at_full_scale: How many stood at the highest code, (n_pixels,).
    """

    n_frames: int
    n_free: int
    mean_dn: Pixels
    variance_dn2: Pixels
    third_dn3: Pixels
    at_zero: NDArray[np.uint32]
    at_full_scale: NDArray[np.uint32]

    @classmethod
    def of(cls, block: PixelSums) -> "ExposureMoments":
        """Return the moments of one block."""
        return cls._of(block, central_moments(block))

    @classmethod
    def finished(cls, accumulator: PixelAccumulator) -> "ExposureMoments":
        """Return the moments of one block, in the memory of its sums, which are gone."""
        return cls._of(*accumulator.finished())

    @classmethod
    def _of(cls, block: PixelSums, moments: Moments) -> "ExposureMoments":
        n = block.n_frames
        values = (moments.mean_dn, moments.variance_dn2, moments.third_dn3)
        return cls(n, n - 1, *values, block.at_zero, block.at_full_scale)

    def merged(self, other: "ExposureMoments") -> "ExposureMoments":
        """Return the moments of both blocks.

        Deviations stay those from each block's own mean, so that a lamp that changed between the
        blocks does not count as noise.
        """
        frames, free = self.n_frames + other.n_frames, self.n_free + other.n_free
        by_frames, by_free = other.n_frames / frames, other.n_free / free
        return ExposureMoments(
            frames,
            free,
            self.mean_dn + by_frames * (other.mean_dn - self.mean_dn),
            self.variance_dn2 + by_free * (other.variance_dn2 - self.variance_dn2),
            self.third_dn3 + by_frames * (other.third_dn3 - self.third_dn3),
            self.at_zero + other.at_zero,
            self.at_full_scale + other.at_full_scale,
        )

    def at(self, pixels: slice | NDArray[np.bool_]) -> "ExposureMoments":
        """Return the moments of some pixels."""
        return ExposureMoments(
            self.n_frames,
            self.n_free,
            self.mean_dn[pixels],
            self.variance_dn2[pixels],
            self.third_dn3[pixels],
            self.at_zero[pixels],
            self.at_full_scale[pixels],
        )

    def arrays(self, pixels: slice = EVERY) -> ExposureArrays:
        """Return what compiled loops take of some pixels."""
        part = self.at(pixels)
        each = (part.mean_dn, part.variance_dn2, part.third_dn3, part.at_zero, part.at_full_scale)
        return ExposureArrays(
            float(self.n_frames), float(self.n_free), *map(np.ascontiguousarray, each)
        )


@dataclass(frozen=True)
class ExposurePair:
    """A scene at t and at r·t.

    Attributes:
        first: At t.
        second: At r·t.
        ratio: r, 2 for SANUC's equations as printed; as read back from the camera.
        ratio_std: Its standard uncertainty; every pixel shares this error.
    """

    first: ExposureMoments
    second: ExposureMoments
    ratio: float = 2.0
    ratio_std: float = 0.0

    @property
    def n_pixels(self) -> int:
        """How many pixels there are."""
        return self.first.mean_dn.size

    @property
    def difference_dn(self) -> Pixels:
        """D = D̄₂ − D̄₁, (n_pixels,)."""
        return self.second.mean_dn - self.first.mean_dn

    @property
    def variance_difference_dn2(self) -> Pixels:
        """V = σ₂² − σ₁², (n_pixels,), DN²; rounding and read noise cancel in it."""
        return self.second.variance_dn2 - self.first.variance_dn2

    @cached_property
    def ratio_of_sums(self) -> float:
        """ΣV/ΣD over pixels that nowhere clip, DN/e⁻: a first system gain, 0 where there is none.

        It stands in for each pixel's own gain in the small terms of the errors (third and higher
        cumulants), where the pixel's own would bring its noise along.
        """
        (m1, m2), (v1, v2) = self.unclipped_sums.means_dn, self.unclipped_sums.variances_dn2
        return max((v2 - v1) / (m2 - m1), 0.0) if m2 > m1 else 0.0

    @cached_property
    def unclipped_sums(self) -> UnclippedSums:
        """Sums over the pixels of which no sample clips, and how many others there are."""
        return unclipped_sums(self.arrays(0.0))

    @cached_property
    def unclipped(self) -> NDArray[np.bool_]:
        """Pixels of which no sample clips, (n_pixels,)."""
        clipped = self.first.at_zero | self.first.at_full_scale
        clipped |= self.second.at_zero
        clipped |= self.second.at_full_scale
        return np.asarray(clipped == 0)

    def at(self, pixels: slice | NDArray[np.bool_]) -> "ExposurePair":
        """Return the pair of some pixels."""
        return ExposurePair(
            self.first.at(pixels), self.second.at(pixels), self.ratio, self.ratio_std
        )

    def arrays(self, gain_dn_per_e: float, pixels: slice = EVERY) -> PairArrays:
        """Return what compiled loops take of some pixels; the gain is for higher cumulants."""
        one, two = self.first.arrays(pixels), self.second.arrays(pixels)
        return PairArrays(one, two, self.ratio, self.ratio_std, gain_dn_per_e)
