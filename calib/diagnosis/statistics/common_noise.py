"""How much of the noise all pixels of a line share, block by block."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SIGNIFICANT = 14.0
"""Deviance that shared noise has to explain before it counts."""
ROUNDS = 6
"""Of least squares, each with the scatter of the fit before."""


@dataclass(frozen=True)
class CommonNoise:
    """Variance that a line's pixels share: fixed + relative x signal^2, and what each tap adds.

    Attributes:
        fixed_dn2: In the dark and everywhere.
        relative: Of the signal, squared.
        memory: By how much the variance of a block's mean exceeds that of white lines.
        rows_share: The part of it that all rows of a frame share, 0 to 1; 0 for lines.
        of_taps_dn2: What pixels of one tap share besides, and those of another do not.
    """

    fixed_dn2: float
    relative: float
    memory: float
    rows_share: float = 0.0
    of_taps_dn2: float = 0.0

    def shared_dn2(self, signal_dn: float) -> float:
        """Return the variance that a line's pixels share at a signal, DN^2."""
        return self.fixed_dn2 + self.relative * signal_dn**2

    def tap_mean_dn2(self, n_lines: float, present: NDArray[np.bool_]) -> Floats:
        """Return the variance of a block's mean that each tap has for itself, DN^2, (n_taps,).

        Args:
            n_lines: Lines, or frames, of the block.
            present: Which taps a row has, (n_rows, n_taps).
        """
        of_rows = np.array([self.of_mean_of_rows(max(int(n), 1)) for n in present.sum(axis=0)])
        memory = self.memory if len(present) == 1 else 1.0
        return np.asarray(self.of_taps_dn2 * memory / n_lines * of_rows)

    def of_mean_of_rows(self, n_rows: int) -> float:
        """Return which part of the shared variance is left of the mean of a frame's rows."""
        return self.rows_share + (1.0 - self.rows_share) / n_rows


def fit_common_noise(
    excess: Floats,
    lagged: Floats,
    white: Floats,
    signal: Floats,
    freedom: Floats,
    *,
    n_rows: int = 1,
    of_taps_dn2: float = 0.0,
    taps: float = 1.0,
) -> CommonNoise:
    """Return the fit of the excess of line means' variances.

    Args:
        excess: Variance of the line means beyond what independent pixels give, DN^2, (n_blocks,).
        lagged: Sum of their covariances one and two lines apart, (n_blocks,); of a frame's rows,
            one row apart.
        white: What independent pixels give, (n_blocks,).
        signal: Mean signal, DN, (n_blocks,).
        freedom: Degrees of freedom of each variance, (n_blocks,).
        n_rows: Of a frame, whose rows follow each other; lines follow each other themselves.
        of_taps_dn2: What pixels of a tap share besides; see `fit_noise_of_taps`.
        taps: How many taps a row has.
    """
    apart = of_taps_dn2 / taps
    excess, white = excess - apart, white + apart
    best = (0.0, 0.0)
    least = _deviance(excess, white, white, freedom)
    for columns in ((1, 0), (0, 1), (1, 1)):
        found, deviance = _fitted(columns, excess, white, signal, freedom)
        if deviance + SIGNIFICANT * sum(columns) < least:
            least, best = deviance + SIGNIFICANT * sum(columns), found
    if best == (0.0, 0.0) and of_taps_dn2 == 0.0:
        return CommonNoise(0.0, 0.0, 1.0)
    total = float((best[0] + best[1] * signal**2 + apart).sum())
    ratio = float(lagged.sum()) / max(total, 1e-300)
    if n_rows > 1:
        # Frames are exposed one by one: what two rows share, all of them do.
        share = float(np.clip(ratio, 0.0, 1.0))
        return CommonNoise(*best, 1.0 + share * (n_rows - 1), share, of_taps_dn2)
    memory = float(np.clip(1.0 + 2.0 * ratio, 0.1, 6.0))
    return CommonNoise(*best, memory, of_taps_dn2=of_taps_dn2)


def fit_noise_of_taps(apart: Floats, white: Floats, freedom: Floats) -> float:
    """Return what pixels of one tap share and those of another do not, DN^2, 0 by chance.

    Args:
        apart: Variance of taps' means less the covariance of two, beyond what independent pixels
            give, DN^2, (n_blocks,).
        white: What independent pixels give, (n_blocks,).
        freedom: Degrees of freedom of each, (n_blocks,).
    """
    none = np.zeros_like(white)
    (fixed, _), deviance = _fitted((1, 0), apart, white, none, freedom)
    return fixed if deviance + SIGNIFICANT < _deviance(apart, white, white, freedom) else 0.0


def _fitted(
    columns: tuple[int, int], excess: Floats, white: Floats, signal: Floats, freedom: Floats
) -> tuple[tuple[float, float], float]:
    """Return what is fixed, DN^2, and relative, where `columns` says so, and the deviance left."""
    design = np.stack([np.ones_like(signal), signal**2], axis=1) * np.array(columns)
    level = white.copy()
    found = np.zeros(2)
    for _ in range(ROUNDS):
        std = np.sqrt(2.0 / freedom) * level
        solved = np.linalg.lstsq(design / std[:, None], excess / std, rcond=None)[0]
        found = np.maximum(solved * np.array(columns), 0.0)
        level = white + design @ found
    fixed, relative = found.tolist()
    return (fixed, relative), _deviance(excess - design @ found, level, white, freedom)


def _deviance(residual: Floats, level: Floats, white: Floats, freedom: Floats) -> float:
    """Return minus twice the log likelihood of scaled chi-squared variances, up to a constant."""
    measured = np.maximum(residual + level, 1e-12 * white)
    return float((freedom * (np.log(level / white) + measured / level)).sum())
