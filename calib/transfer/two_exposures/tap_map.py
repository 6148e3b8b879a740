"""Which tap reads which pixel, of lines and of frames."""

import numpy as np
from numpy.typing import NDArray

from calib.forward.taps import taps_of_camera
from calib.recording.header import CameraHeader


def image_shape(camera: CameraHeader) -> tuple[int, ...]:
    """Return (n_rows, n_columns), or (n_columns,) of a line sensor."""
    return (camera.columns,) if camera.rows is None else (camera.rows, camera.columns)


def tap_of_pixel(camera: CameraHeader) -> NDArray[np.uint8]:
    """Return the tap, from 0, that reads each pixel, (n_pixels,), rows one after the other.

    >>> camera = CameraHeader(columns=4, rows=2, bit_depth=12, taps=4, tap_layout="quadrants")
    >>> tap_of_pixel(camera)
    array([0, 0, 1, 1, 2, 2, 3, 3], dtype=uint8)
    """
    return taps_of_camera(camera).astype(np.uint8).ravel()
