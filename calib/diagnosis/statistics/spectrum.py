"""Power of a block's residuals, of what all pixels of a line share and of what runs through them.

A tone of the electronics of f cycles a line runs on from pixel to pixel and from line to line: a
sine of all samples in the order in which they are read out. Its power at f = c + k / n, c whole and
n lines, is put at line frequency k and column frequency c. Of a two-dimensional spectrum, in which
it has c + k / n cycles along a line all the same, up to 60 % of it would be lost between two
column frequencies. The column of frequency 0 holds what differs from line to line instead.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from calib.diagnosis.statistics.block_sums import PADDING

Floats = NDArray[np.float64]


def power_spectrum(flat: NDArray[np.generic], mean: Floats, cut: Floats) -> NDArray[np.float32]:
    """Return the power, (2 n_lines, n_pixels // 2 + 1); its mean is the variance.

    Args:
        flat: Codes, (n_lines, n_pixels).
        mean: Of each pixel, (n_pixels,).
        cut: Deviations beyond this are taken for none, likewise.
    """
    plane = flat.astype(np.float32) - mean.astype(np.float32)
    plane[np.abs(plane) > cut.astype(np.float32)] = 0.0
    n, n_pixels = PADDING * len(plane), plane.shape[1]
    power = np.empty((n, n_pixels // 2 + 1), np.float32)
    shared = plane.sum(axis=1)
    plane -= shared[:, None] / np.float32(n_pixels)
    running = fft.rfft(plane.ravel(), n * n_pixels, workers=2)
    _fold(np.asarray(running.real**2 + running.imag**2, np.float32), power)
    common = fft.fft(shared, n)
    power[:, 0] = common.real**2 + common.imag**2
    power /= np.float32(plane.size)
    return power


def _fold(running: NDArray[np.float32], power: NDArray[np.float32]) -> None:
    """Put what turns q times in all lines, padded ones too, n of them, at q = n c + k.

    c is the column frequency, k the line frequency, -n / 2 to n / 2, cyclic. Beyond the highest
    frequency the spectrum of real samples repeats itself backwards.
    """
    n, n_columns = power.shape
    half = n // 2
    mirrored = np.concatenate([running, running[-2 : -half - 2 : -1]])
    rows = mirrored[half : half + n * (n_columns - 1)].reshape(n_columns - 1, n)
    power[:half, 1:] = rows[:, half:].T
    power[half:, 1:] = rows[:, :half].T
