"""A straight line of noise against signal, from the cells themselves: how far rounding is undone.

    σ² = K·s + σ_r²,    DN², before rounding, of each tap

It only says how much noise a cell has, to a few per cent; the curve is fitted afterwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.noise_sums import noise_sums
from calib.rounding import INVERTIBLE_SIGMA_DN, NEGLIGIBLE_SIGMA_DN, SMALLEST_SIGMA_DN
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.classes import Numbers
from calib.transfer.photon_transfer.dark_level import DarkLevel

_STEPS = 12
_SETTLED = 1e-3
_LEAST_DN2 = 0.25 * SMALLEST_SIGMA_DN**2
_MOST_CELLS = 60_000
"""So many of all blocks' cells tell the noise to 1 % and better."""


@dataclass(frozen=True)
class NoiseLine:
    """Noise of each tap, (n_taps,) each.

    Attributes:
        system_gain: K, DN per electron.
        read_variance_dn2: σ_r², DN².
    """

    system_gain: Columns
    read_variance_dn2: Columns

    def variance(self, signal_dn: Columns, tap: Numbers) -> Columns:
        """Return σ² of cells, DN²."""
        shot = self.system_gain[tap] * np.maximum(signal_dn, 0.0)
        return np.asarray(shot + self.read_variance_dn2[tap])


def noise_line(
    blocks: Sequence[BlockCells], dark: DarkLevel, tap: Numbers, use: NDArray[np.bool_]
) -> NoiseLine:
    """Return every tap's line.

    Args:
        blocks: Flats and darks, as they were recorded.
        dark: Their dark level.
        tap: (n_cells,).
        use: (n_blocks, n_cells).
    """
    found = [_of_tap(blocks, dark, tap, t, use) for t in range(int(tap.max()) + 1)]
    return NoiseLine(np.array([k for k, _ in found]), np.array([r for _, r in found]))


def _of_tap(
    blocks: Sequence[BlockCells],
    dark: DarkLevel,
    tap: Numbers,
    number: int,
    use: NDArray[np.bool_],
) -> tuple[float, float]:
    """Return K and σ_r² by Newton's steps of `noise_sums`; what is unknown is nothing."""
    own = tap == number
    step = max(1, int(own.sum()) * len(blocks) // _MOST_CELLS)
    rows = []
    for block, good in zip(blocks, use, strict=True):
        cells = np.flatnonzero(own & good & np.isfinite(block.variance_dn2))[::step]
        signal = np.maximum(dark.signal_dn(block, tap), 0.0)
        freedom = 2.0 / block.square_factor
        rows.append(np.stack([signal, block.mean_dn, block.variance_dn2, freedom])[:, cells])
    signal, code, variance, freedom = np.ascontiguousarray(np.concatenate(rows, axis=1))
    if not len(signal):
        return 0.0, NEGLIGIBLE_SIGMA_DN**2
    line, restored = (0.0, max(float(variance.mean()) - 1.0 / 12.0, _LEAST_DN2)), code.copy()
    for _ in range(_STEPS):
        sums = noise_sums(
            (signal, code, variance, freedom),
            restored,
            line,
            smallest_dn=INVERTIBLE_SIGMA_DN,
            negligible_dn=NEGLIGIBLE_SIGMA_DN,
        )
        spread = sums.hss * sums.h - sums.hs**2
        gain = max((sums.hsy * sums.h - sums.hs * sums.hy) / spread, 0.0) if spread > 0 else 0.0
        floor = max((sums.hy - gain * sums.hs) / sums.h, _LEAST_DN2)
        moved = abs(floor - line[1]) / floor + abs(gain - line[0]) / max(gain, 1e-9)
        line = gain, floor
        if moved < _SETTLED:
            break
    return line
