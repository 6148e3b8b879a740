"""How far rounding to whole codes could be undone."""

from enum import Enum
from typing import Self

import numpy as np

from calib.rounding import SMALLEST_SIGMA_DN
from calib.transfer.photon_transfer.points import Points

_WHITE_DN = 0.5
"""From here on variances swing by 2 % and less."""


class Rounding(Enum):
    """How a tap's read noise was told from rounding.

    WHITE: the noise is so large that rounding adds 1/12 DN² at any mean. BY_CELL: each cell's
    phase is known. ON_AVERAGE: over cells or pixels of all phases. HIDDEN: the noise is below
    0.1 DN, and the read noise is not determined.
    """

    WHITE = "adds 1/12 DN2"
    BY_CELL = "undone cell by cell"
    ON_AVERAGE = "undone on average"
    HIDDEN = "hides the noise"

    @classmethod
    def of(cls, read_variance_dn2: float, points: Points) -> Self:
        """Return what holds of a read noise, by the darks among `points`."""
        if read_variance_dn2 < SMALLEST_SIGMA_DN**2:
            return cls(cls.HIDDEN)
        if read_variance_dn2 >= _WHITE_DN**2:
            return cls(cls.WHITE)
        unknown = bool(np.any(points.phase_factor[points.is_dark] > 0))
        return cls(cls.ON_AVERAGE if unknown else cls.BY_CELL)
