"""The image of an edge, exact: an edge is the middle of a long square wave's period."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import PixelResponse

_PIXELS_PER_PERIOD = 4.0
_HIGHEST = 6.0  # in units of 1/pitch: beyond, a pixel passes next to nothing


def edge_image(
    response: PixelResponse,
    pitch_um: float,
    shape: tuple[int, int],
    columns_per_row: float,
    *,
    moving: bool = False,
    contrast: float = 0.8,
) -> NDArray[np.floating]:
    """Return the light of an edge that crosses the columns, 1 ± contrast far from it.

    Args:
        response: The pixel's.
        pitch_um: µm.
        shape: (n_rows, n_columns); the edge crosses the centre.
        columns_per_row: How far it moves from row to row.
        moving: The edge stays upright and moves, seen by a line sensor.
        contrast: Half the step.
    """
    n_rows, n_columns = shape
    angle = 0.0 if moving else np.arctan(columns_per_row)
    row, column = np.arange(n_rows) - (n_rows - 1) / 2, np.arange(n_columns) - (n_columns - 1) / 2
    away = pitch_um * np.cos(angle) * (column - columns_per_row * row[:, None])
    period = _PIXELS_PER_PERIOD * float(np.abs(away).max())
    order = np.arange(1, int(_HIGHEST / pitch_um * period), 2)
    frequency = order / period
    transfer = response.transfer(frequency * np.cos(angle), -frequency * np.sin(angle))
    wave = np.exp(2j * np.pi * np.multiply.outer(away, frequency)) @ (transfer / order)
    return np.asarray(1 + contrast * 4 / np.pi * wave.imag)


def noisy(
    light: NDArray[np.floating], noise: DetectorNoise, rng: Generator
) -> NDArray[np.floating]:
    """Return what a detector records of `light`, electrons."""
    gain, offset = noise.maps((light.shape[0], light.shape[1]), rng)
    return noise.record(light, gain, offset, rng)
