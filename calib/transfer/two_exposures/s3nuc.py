"""S3NUC: gain, bias, photo-electrons and read noise from three moments at any two exposures.

Source: Yielding, Cain and Seal (2018), Eqs. 1-12 (after Catarius and Seal 2015). The skewness of
Eqs. 6 and 9 times σ³ is the third central moment; with T its unbiased estimate k₃ of the first
exposure, D = D̄₂ − D̄₁ and V = σ₂² − σ₁²:

    G  = V/D                        (8)         ΔK̄ = D/G = D²/V        (11)
    K̄  = T/G³                       (9)         B  = D̄₁ − T/G²         (10)
    σ² = σ₁² − T/G − 1/12           (12), without rounding (Sheppard)

The system is overdetermined: Eq. 7, the second exposure's skewness, is not used, as in the paper.
T/G^p is biased by G's noise, and as T and V come from the same frames; to second order by

    1 + p(p+1)/2·var(ln G) − p·cov(ln T, ln G),

which is divided by. No matter how long one records, T's noise √(6σ⁶/n) is 1 or more of its value
G³·K̄ until n reaches 6·K̄.
"""

from calib.kernels.s3nuc_maps import s3nuc_maps
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps, by_pixel


def s3nuc(pair: ExposurePair) -> PixelMaps:
    """Return the maps of Eqs. 8-12 with their standard uncertainties; `ratio` is not used."""
    return by_pixel(pair, s3nuc_maps)
