"""Variances of a transfer function on a grid, from the covariance of its PSF's cells."""

import numpy as np
from numpy.typing import NDArray

from calib.mtf.harmonic_sums import Complex

Matrix = NDArray[np.floating]


def on_frequencies(
    covariance: Matrix,
    along_x: Complex,
    along_y: Complex,
    functionals: Matrix | None = None,
    lever: Complex | None = None,
) -> tuple[Matrix, Complex]:
    """Return E|δT|² and E[δT²] at every pair of frequencies, [fy, fx].

    δT = Σ cells · δshare + Σ_d lever_d · (functional_d · δshare): along each axis, cells are a
    product.

    Args:
        covariance: Of the shares, (n², n²), rows first.
        along_x: (n_fx, n).
        along_y: (n_fy, n).
        functionals: (n_d, n²); None for none.
        lever: (n_d, n_fy, n_fx).
    """
    n = along_x.shape[1]
    blocks = covariance.reshape(n, n, n, n).transpose(0, 2, 1, 3)
    half = along_x @ blocks  # [y, y', fx, x']
    spread = _other_half(half, along_x.conj(), along_y, along_y.conj()).real
    pseudo = _other_half(half, along_x, along_y, along_y)
    if functionals is None or lever is None:
        return spread, pseudo
    seen = (covariance @ functionals.T).T.reshape(-1, n, n)
    mixed = along_y @ seen @ along_x.T
    among = functionals @ covariance @ functionals.T
    spread = spread + 2 * (lever.conj() * mixed).sum(0).real
    spread += np.einsum("dyx,de,eyx->yx", lever, among, lever.conj()).real
    pseudo = pseudo + 2 * (lever * mixed).sum(0)
    pseudo += np.einsum("dyx,de,eyx->yx", lever, among, lever)
    return spread, pseudo


def _other_half(half: Complex, again_x: Complex, along_y: Complex, again_y: Complex) -> Complex:
    by_x = np.einsum("yzfx,fx->fyz", half, again_x)
    found: Complex = np.einsum("fyz,gy,gz->gf", by_x, along_y, again_y, optimize=True)
    return found
