"""How much of a pixel's charge goes another way than the rest.

Each electron that decides for itself makes the number binomial (partition noise; Thornber and
Tompsett, Spectral density of noise generated in charge transfer devices, IEEE Trans. Electron
Devices 20, 456 (1973), for transfers). Splitting Poisson counts so gives Poisson counts that are
independent (Kingman, Poisson Processes, 1993, section 5.1): shot noise that the split smooths and
partition noise that it adds cancel exactly, so in steady uniform light neither variances nor
covariances show that charge was moved. Where potentials or the number of traps set the share, as
after the soft reset of a three-transistor pixel (Pain et al., Analysis and enhancement of low-light
level performance of photodiode-type CMOS active pixel imagers, IEEE CCD workshop 1999), there is no
partition noise, variance falls, and neighbours correlate.
"""

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from calib.arrays import Lines


def part_of(
    charge: Lines, share: ArrayLike, partition_noise: float, rng: Generator
) -> NDArray[np.float64]:
    """Return how many electrons of each pixel's `charge` are in the part of mean `share`.

    Args:
        charge: Electrons, any shape.
        share: 0 .. 1, of a shape that broadcasts to it.
        partition_noise: Standard deviation relative to binomial: 1 for independent electrons,
            whole ones where `charge` is; 0 for exactly the share.
        rng: Where the randomness comes from.

    >>> part_of(np.full(3, 100.0), 0.02, 0.0, np.random.default_rng(1))
    array([2., 2., 2.])
    """
    share = np.asarray(share, np.float64)
    mean = np.asarray(charge * share, np.float64)
    if partition_noise == 0.0:
        return mean
    whole = np.rint(np.maximum(charge, 0.0)).astype(np.int64)
    drawn = rng.binomial(whole, share)
    if partition_noise == 1.0:
        return drawn.astype(np.float64)
    return np.asarray(mean + partition_noise * (drawn - whole * share))
