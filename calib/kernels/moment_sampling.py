"""How one pixel's mean, k₂ and k₃ scatter: the compiled form of `two_exposures.sampling`.

    var m      = κ₂/n                           cov(m, k₂)  = κ₃/n
    var k₂     = κ₄/n + 2κ₂²/ν                  cov(m, k₃)  = κ₄/n
    var k₃     = κ₆/n + 9(κ₂κ₄ + κ₃²)/ν + 6nκ₂³/((n−1)(n−2))
    cov(k₂,k₃) = κ₅/n + 6κ₂κ₃/ν

with κ_r = G^(r−1)·q for r ≥ 3, q the signal in DN, and κ₂² and κ₂³ estimated without bias. The
source, and what is left out, stand there.
"""

from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def factors(exposure):  # type: ignore[no-untyped-def]
    """Return what all pixels of an exposure share: 1/n, 1/ν, and those of κ₂² and of κ₂³."""
    n, free = exposure.n_frames, exposure.n_free
    cubed = 6.0 * n / max((n - 1.0) * (n - 2.0), 1.0) / (1.0 + 6.0 / free + 8.0 / free**2)
    return 1.0 / n, 1.0 / free, 2.0 / (free + 2.0), cubed


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def two_moments(of_exposure, k2, q, g):  # type: ignore[no-untyped-def]
    """Return var m, cov(m, k₂) and var k₂."""
    per_frame, _, squared, _ = of_exposure
    third = g * g * q * per_frame
    fourth = g * third
    return k2 * per_frame, third, fourth + squared * max(k2 * k2 - fourth, 0.0)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def third_moment(of_exposure, k2, q, g):  # type: ignore[no-untyped-def]
    """Return cov(m, k₃), cov(k₂, k₃) and var k₃."""
    per_frame, per_free, _, cubed = of_exposure
    third = g * g * q
    fourth = g * third
    fifth = g * fourth
    mixed = k2 * fourth + third * third
    return (
        fourth * per_frame,
        fifth * per_frame + 6.0 * k2 * third * per_free,
        g * fifth * per_frame + 9.0 * mixed * per_free + cubed * k2 * k2 * k2,
    )
