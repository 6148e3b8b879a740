"""The mean images of one scan, and what they were taken with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.mtf.geometry import Alignment, Sampling, Scan
from calib.mtf.grating.grating import Grating


@dataclass(frozen=True, eq=False)
class ScanImages:
    """Images of a grating by stage position, dark removed.

    Attributes:
        scan: The nominal geometry.
        grating: What was projected.
        images: (n_frames, n_rows, n_columns), in any unit; finite.
        positions: The stage position k of each image.
    """

    scan: Scan
    grating: Grating
    images: NDArray[np.floating]
    positions: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.images.ndim != 3 or len(self.images) != len(self.positions):
            msg = f"images of shape {self.images.shape} are no {len(self.positions)} frames of an"
            msg += " area: give (n_frames, n_rows, n_columns) and a position for each"
            raise InputError(msg, code="frames-wrong-shape")
        if not np.isfinite(self.images).all():
            k = int(np.argwhere(~np.isfinite(self.images))[0, 0])
            msg = f"frame {self.positions[k]:03d} holds a number that is not finite: take it again"
            raise InputError(msg, code="frames-not-finite")

    @classmethod
    def whole(cls, scan: Scan, grating: Grating, images: NDArray[np.floating]) -> "ScanImages":
        """Return a scan with all stage positions."""
        return cls(scan, grating, images, tuple(range(scan.positions)))

    def sampling(self, alignment: Alignment | None = None) -> Sampling:
        """Return where these images sample the pattern."""
        n_rows, n_columns = self.images.shape[1:]
        return Sampling(self.scan, n_rows, n_columns, self.positions, alignment or Alignment())

    def without(self, left_out: tuple[int, ...]) -> "ScanImages":
        """Return the scan without the images at these indices (not positions)."""
        keep = [i for i in range(len(self.positions)) if i not in left_out]
        kept = tuple(self.positions[i] for i in keep)
        return ScanImages(self.scan, self.grating, self.images[keep], kept)
