"""What compiled loops are given of two exposures: the moments of their pixels, and what all share.

Named tuples, since Numba takes them apart at compile time; every array is (n_pixels,).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.kernels.pixel_sums import Pixels


class ExposureArrays(NamedTuple):
    """One exposure.

    Attributes:
        n_frames: n.
        n_free: ν, frames less blocks.
        mean: DN.
        variance: k₂, DN².
        third: k₃, DN³.
        at_zero: Samples at code 0.
        at_full_scale: Samples at the highest code.
    """

    n_frames: float
    n_free: float
    mean: Pixels
    variance: Pixels
    third: Pixels
    at_zero: NDArray[np.uint32]
    at_full_scale: NDArray[np.uint32]


class PairArrays(NamedTuple):
    """Two exposures.

    Attributes:
        first: At t.
        second: At r·t.
        ratio: r.
        ratio_std: Its standard uncertainty.
        gain_dn_per_e: One gain for all pixels, for third and higher cumulants.
    """

    first: ExposureArrays
    second: ExposureArrays
    ratio: float
    ratio_std: float
    gain_dn_per_e: float
