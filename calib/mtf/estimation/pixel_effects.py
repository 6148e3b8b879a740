"""Gain and offset of each pixel as random effects: what K views of the pattern say about them.

A pixel's K signals are (1 + γ)·m_k + o + noise, with γ and o drawn once from zero-mean
distributions. Their variances come from the residuals; generalised least squares then weights a
pixel's signals with the inverse of σ²·1 + Z·B·Zᵀ, Z = [m, 1], B = diag(var γ, var o), which is (1
− Z·G·Zᵀ)/σ², G = (ZᵀZ + σ²·B⁻¹)⁻¹ (Woodbury).

Source: Searle, Casella and McCulloch, Variance Components (1992), sections 5.3 and 7.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.mtf.harmonic_sums import Frames

Map = NDArray[np.floating]
_LEAST_FRAMES = 4
_NEVER = 1e30  # σ²/variance of an effect that is not there


@dataclass(frozen=True, eq=False)
class PixelEffects:
    """How pixels differ.

    Attributes:
        noise: Standard deviation of the rest, in the images' unit.
        gain_std: Of the pixels' relative gain; 0 where none is seen.
        offset_std: Of the pixels' offset, in the images' unit; 0 where none is seen.
        inverse: G by pixel: (n_rows, n_columns, 2, 2).
    """

    noise: float
    gain_std: float
    offset_std: float
    inverse: NDArray[np.floating]

    @property
    def are_seen(self) -> bool:
        """Whether pixels differ at all."""
        return self.gain_std > 0 or self.offset_std > 0

    def of(self, residual: Frames, model: Frames) -> tuple[Map, Map]:
        """Return each pixel's gain less 1 and offset, (n_rows, n_columns) each."""
        seen = np.stack([(residual * model).sum(0), residual.sum(0)], axis=-1)
        gain, offset = np.einsum("rcij,rcj->irc", self.inverse, seen)
        return gain, offset

    def whitened(self, residual: Frames, model: Frames) -> Frames:
        """Return (1 − Z·G·Zᵀ) residual: what a pixel's own gain and offset do not explain."""
        gain, offset = self.of(residual, model)
        return residual - gain * model - offset

    def directions(self, model: Frames) -> Iterator[Frames]:
        """Yield Z·L with G = L·Lᵀ: what is taken out of each pixel, (n_frames, rows, columns)."""
        root = np.linalg.cholesky(self.inverse)
        if self.gain_std > 0:
            yield model * root[..., 0, 0] + root[..., 1, 0]
        if self.offset_std > 0:
            yield np.broadcast_to(root[..., 1, 1], model.shape)


def pixel_effects(residual: Frames, model: Frames, good: NDArray[np.bool_]) -> PixelEffects:
    """Find the variances from the residuals of good pixels (moments, none below 0)."""
    n_frames = len(residual)
    square = np.stack([(model * model).sum(0), model.sum(0)], axis=-1)
    gram = np.empty((*model.shape[1:], 2, 2))
    gram[..., 0, :], gram[..., 1, 0], gram[..., 1, 1] = square, square[..., 1], n_frames
    power = (residual * residual).sum(0)
    if n_frames < _LEAST_FRAMES:
        noise = float(np.sqrt(power[good].mean() / n_frames))
        return PixelEffects(noise, 0.0, 0.0, np.zeros_like(gram) + np.eye(2) / _NEVER)
    alone = np.linalg.inv(gram)
    seen = np.stack([(residual * model).sum(0), residual.sum(0)], axis=-1)
    effects = np.einsum("rcij,rcj->rci", alone, seen)
    left = power - (effects * seen).sum(-1)
    variance = float(left[good].mean()) / (n_frames - 2)
    own = alone[good][:, (0, 1), (0, 1)]
    spread = np.maximum((effects[good] ** 2 / own - variance).sum(0) / (1 / own).sum(0), 0)
    penalty = [variance / each if each > 0 else _NEVER for each in spread]
    inverse = np.linalg.inv(gram + np.diag(np.minimum(penalty, _NEVER)))
    gain, offset = np.sqrt(spread).tolist()
    return PixelEffects(float(np.sqrt(variance)), gain, offset, inverse)
