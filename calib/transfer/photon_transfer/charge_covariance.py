"""Variances and covariances of neighbours under the brighter-fatter effect, all lags together.

The charge that a pixel has gathered moves the boundaries of the pixels around it by a share a_ij
per electron, so that with N = x/K electrons (Astier et al. 2019, Eq. 20, here in DN²)

    C_ij = K²·N·[δ_ij + a_ij·N + (2/3)·(a∗a + a·b)_ij·N² + (1/6)·(2·a∗a∗a + 5·a∗(a·b))_ij·N³] + n_ij

a and b are even in both lags, ∗ is the convolution over all lags, a·b the product lag by lag. The
first-order form keeps the first two terms. a00 < 0: a full pixel shrinks; the sum of all a is 0 if
no charge is lost. b = 0 means that boundaries move in proportion to the charge. Lags beyond those
that are given are taken as a = 0.
"""

from enum import Enum

import numpy as np
from numpy.typing import NDArray
from scipy.signal import convolve2d

from calib.arrays import Columns

Kernel = NDArray[np.float64]
"""By lag in rows and columns, not negative, (n_rows, n_columns)."""


class Form(Enum):
    """How much of the series is kept."""

    FIRST_ORDER = "first_order"
    FULL = "full"
    FULL_WITH_B = "full_with_b"


def covariance_model(
    electrons: Columns, gain: float, a: Kernel, ab: Kernel, form: Form
) -> NDArray[np.float64]:
    """Return C_ij without n_ij, DN², (n_rows, n_columns, n_points).

    >>> a = np.array([[-1e-6, 2e-7]])
    >>> c = covariance_model(np.array([1e4]), 0.5, a, 0 * a, Form.FIRST_ORDER)
    >>> c[0, :, 0].tolist()
    [2475.0, 5.0]
    """
    n = electrons
    unit = np.zeros(a.shape)
    unit[0, 0] = 1.0
    total = unit[..., None] + a[..., None] * n
    if form is not Form.FIRST_ORDER:
        two = _convolved(a, a)
        three = _convolved(two, a, keep=a.shape)
        total = total + (2.0 / 3.0) * (_cut(two, a.shape) + ab)[..., None] * n**2
        mixed = _cut(_convolved(a, ab), a.shape)
        total = total + (2.0 * three + 5.0 * mixed)[..., None] / 6.0 * n**3
    return np.asarray(gain**2 * n * total)


def _even(half: Kernel) -> Kernel:
    """Return the kernel over negative lags, too."""
    wide = np.concatenate([half[:, :0:-1], half], axis=1)
    return np.concatenate([wide[:0:-1], wide], axis=0)


def _convolved(one: Kernel, other: Kernel, keep: tuple[int, ...] | None = None) -> Kernel:
    """Return the quadrant of lags ≥ 0 of the convolution of two even kernels."""
    full = convolve2d(_even(one), _even(other))
    rows, columns = full.shape[0] // 2, full.shape[1] // 2
    half = full[rows:, columns:]
    return half if keep is None else _cut(half, keep)


def _cut(kernel: Kernel, shape: tuple[int, ...]) -> Kernel:
    return kernel[: shape[0], : shape[1]]
