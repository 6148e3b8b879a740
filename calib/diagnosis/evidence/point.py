"""A difference between recording and baseline in the space where noise has unit size."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Point:
    """A whitened vector: of the means, and of all the rest.

    Attributes:
        means: Projected, (n_blocks, n_pixels).
        rest: (n_rest,).
    """

    means: Floats
    rest: Floats

    def __add__(self, other: "Point") -> "Point":
        """Return the sum."""
        return Point(self.means + other.means, self.rest + other.rest)

    def __sub__(self, other: "Point") -> "Point":
        """Return the difference."""
        return Point(self.means - other.means, self.rest - other.rest)

    def __mul__(self, factor: float) -> "Point":
        """Return it scaled."""
        return Point(self.means * factor, self.rest * factor)

    @property
    def nbytes(self) -> int:
        """Size in memory."""
        return self.means.nbytes + self.rest.nbytes
