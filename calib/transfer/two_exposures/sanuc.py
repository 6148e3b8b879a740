"""SANUC: gain, bias, photo-electrons and read noise from means and variances at t and 2t.

Source: Yielding, Cain and Seal (2018), Eqs. 13-20. With D = D̄₂ − D̄₁, V = σ₂² − σ₁² and r the ratio
of the exposures (2 as printed, else as read back), ρ = r − 1:

    G  = V/D                                    (17)
    K̄  = D²/(ρV) / (1 + u²(G)/G²)               (18), with its bias undone
    B  = D̄₁ − G·K̄ = D̄₁ − D/ρ                    (19)
    σ² = σ₁² − G²·K̄ = σ₁² − V/ρ − 1/12          (20), without rounding (Sheppard)

Eq. 18 is a ratio with a noisy denominator: D²/V is too high by V's squared relative uncertainty, on
average, and has no variance at all, since V comes near 0. Divided by 1 + var(ln V − ln D) it is
unbiased to second order and bounded, as V/(V² + u²) is. B and σ² are linear in the moments: neither
gain nor photo-electrons enter, and they are unbiased at any number of frames.
"""

from calib.kernels.sanuc_maps import sanuc_maps
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps, by_pixel


def sanuc(pair: ExposurePair) -> PixelMaps:
    """Return the maps of Eqs. 17-20 with their standard uncertainties."""
    return by_pixel(pair, sanuc_maps)
