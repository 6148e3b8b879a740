"""Means of whole lines, or frames: of all their pixels, of whichever tap."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.kernels.residual_products import tap_sizes

Floats = NDArray[np.float64]


def whole_lines(sums: BlockSums, sensor: Sensor) -> Floats:
    """Return each line's mean deviation from the block's mean, DN, (n_lines,).

    Each row's mean of a tap counts as often as it has pixels of that tap: of four taps, each with
    a quadrant of the sensor, a row has two, and the others' means are none.
    """
    share = tap_sizes(sensor.tap, sensor.n_taps) / sensor.n_pixels
    return np.asarray((sums.products.line_means * share).sum(axis=(1, 2)))
