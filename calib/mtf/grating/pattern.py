"""The pattern itself, exact: the sum of its harmonics."""

import numpy as np
from numpy.typing import NDArray

from calib.mtf.grating.harmonics import Harmonics

Image = NDArray[np.floating]


def intensity(
    harmonics: Harmonics,
    x_um: NDArray[np.floating],
    y_um: NDArray[np.floating],
    transfer: NDArray[np.complex128] | None = None,
) -> Image:
    """Return the pattern, mean 1, at points (x, y) in µm of its own frame; one number for each.

    Args:
        harmonics: The pattern's.
        x_um: Any shape.
        y_um: The same shape.
        transfer: What each harmonic's amplitude is multiplied by, (n,); None for 1.
    """
    amplitude = harmonics.amplitude if transfer is None else harmonics.amplitude * transfer
    total = np.ones(x_um.shape)
    for (fx, fy), each in zip(harmonics.frequency_per_um, amplitude, strict=True):
        total += 2 * (each * np.exp(2j * np.pi * (fx * x_um + fy * y_um))).real
    return total


def on_grid(
    harmonics: Harmonics,
    x_um: NDArray[np.floating],
    y_um: NDArray[np.floating],
    amplitude: NDArray[np.complex128] | None = None,
    mean: float = 1.0,
) -> Image:
    """Return the pattern on a grid, (len(y), len(x)): on it, each harmonic is a product.

    Args:
        harmonics: The pattern's.
        x_um: Columns of the grid, µm.
        y_um: Rows of the grid, µm.
        amplitude: In place of the harmonics' own, (n,).
        mean: In place of 1.
    """
    p, q = harmonics.index.T
    columns, rows = np.arange(p.max() + 1), np.arange(q.min(), q.max() + 1)
    spectrum = np.zeros((len(rows), len(columns)), np.complex128)
    spectrum[q - q.min(), p] = harmonics.amplitude if amplitude is None else amplitude
    turn = 2j * np.pi / harmonics.period_um
    along_y = np.exp(turn * np.multiply.outer(y_um, rows)) @ spectrum
    along_x = np.exp(turn * np.multiply.outer(columns, x_um))
    image: Image = along_y.real @ along_x.real - along_y.imag @ along_x.imag
    return mean + 2 * image
