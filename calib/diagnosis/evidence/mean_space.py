"""The space of block means: whitened, free of what each pixel's offset and slope absorb.

A vector of it has one entry per block and pixel, (n_blocks, n_pixels). Lines of a block move
together where line noise, jitter or flicker is at work, and with them all its pixels' means: such
common modes have a variance of their own (Woodbury's identity).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class MeanSpace:
    """Inner products of mean vectors.

    Attributes:
        weight: One over the standard error of each mean, 0 where it is not used.
        basis: Orthonormal directions that pixels absorb, (k, n_blocks, n_pixels).
        modes: Whitened profiles of the blocks' common modes, (m, n_pixels).
        mode_block: The block of each, (m,).
        capacitance: Inverse of Woodbury's small matrix, (m, m).
        log_determinant: Of the projected covariance, up to a constant.
    """

    weight: Floats
    basis: Floats
    modes: Floats
    mode_block: NDArray[np.intp]
    capacitance: Floats
    log_determinant: float

    def project(self, means: Floats) -> Floats:
        """Return means, DN, whitened and without what pixels absorb."""
        white = means * self.weight
        for direction in self.basis:
            white = white - direction * np.einsum("bp,bp->p", direction, white)
        return white

    def onto_modes(self, white: Floats) -> Floats:
        """Return the part of a projected vector along each common mode, (m,)."""
        return np.asarray(np.einsum("mp,mp->m", self.modes, white[self.mode_block]))

    def product(self, one: Floats, other: Floats) -> float:
        """Return the inner product of two projected vectors."""
        plain = float(np.vdot(one, other))
        if len(self.modes) == 0:
            return plain
        return plain - float(self.onto_modes(one) @ self.capacitance @ self.onto_modes(other))

    @property
    def degrees_of_freedom(self) -> int:
        """How many means are used, less what pixels absorb."""
        used = int((self.weight > 0).sum())
        return used - int((np.einsum("kbp,kbp->kp", self.basis, self.basis) > 0.5).sum())


def mean_space(
    weight: Floats,
    regressors: tuple[Floats, ...],
    modes: Floats,
    mode_block: NDArray[np.intp],
    mode_variance: Floats,
) -> MeanSpace:
    """Return the space.

    Args:
        weight: One over the standard error of each mean, (n_blocks, n_pixels); 0 leaves it out.
        regressors: What each pixel has a coefficient of its own for, (n_blocks,) or
            (n_blocks, n_pixels) each.
        modes: Profiles in DN, (m, n_pixels).
        mode_block: Their blocks.
        mode_variance: The variance of each mode's amplitude in the block's mean.
    """
    directions = _absorbed(weight, regressors)
    kept = mode_variance > 0
    white, block, variance = (
        modes[kept] * weight[mode_block[kept]],
        mode_block[kept],
        mode_variance[kept],
    )
    gram = np.where(block[:, None] == block[None, :], white @ white.T, 0.0)
    for direction in directions:
        along = white * direction[block]
        gram = gram - along @ along.T
    small = np.diag(1.0 / variance) + gram
    _, logdet = np.linalg.slogdet(small * np.sqrt(np.outer(variance, variance)))
    inverse: Floats = np.zeros((0, 0))
    if len(small):
        inverse = np.asarray(np.linalg.pinv(small), np.float64)
    return MeanSpace(weight, directions, white, block, inverse, float(logdet))


def _absorbed(weight: Floats, regressors: tuple[Floats, ...]) -> Floats:
    """Return orthonormal directions that each pixel's coefficients absorb, (k, *weight.shape)."""
    basis: list[Floats] = []
    for regressor in regressors:
        column = weight * (regressor[:, None] if regressor.ndim == 1 else regressor)
        length = np.einsum("bp,bp->p", column, column)
        for direction in (*basis, *basis):
            column = column - direction * np.einsum("bp,bp->p", direction, column)
        left = np.einsum("bp,bp->p", column, column)
        fine = left > 1e-9 * np.maximum(length, 1e-300)
        basis.append(np.where(fine, column / np.sqrt(np.where(fine, left, 1.0)), 0.0))
    return np.stack(basis) if basis else np.zeros((0, *weight.shape))
