"""A pixel's noise as that of the pixels about it tells it."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor

Floats = NDArray[np.float64]

NEIGHBOURHOODS = 32
"""Of columns, in which a pixel's noise is compared with others'."""


def about_each(variance: Floats, n: int, sensor: Sensor) -> Floats:
    """Return the variance that the pixels of its tap about each have in the middle of them.

    Args:
        variance: Of `n` samples of each pixel, DN^2, (n_rows, n_columns).
        n: Lines.
        sensor: The sensor.
    """
    # The median of chi-squared over its mean (Wilson and Hilferty), far below 1 for few lines.
    return middles(variance, sensor) / (1.0 - 2.0 / (9.0 * max(n - 1, 1))) ** 3


def middles(variance: Floats, sensor: Sensor) -> Floats:
    """Return the median over the pixels of its tap about each, 0.1 DN^2 or more."""
    found = np.empty_like(variance)
    columns = np.arange(sensor.n_columns)
    edges = np.linspace(0, sensor.n_columns, min(NEIGHBOURHOODS, sensor.n_columns // 8 + 1) + 1)
    centres, bounds = (edges[1:] + edges[:-1]) / 2, edges.astype(int)
    for tap in range(sensor.n_taps):
        of_tap = sensor.tap == tap
        known = [
            (x, max(float(np.median(variance[:, a:b][of_tap[:, a:b]])), 0.1))
            for x, a, b in zip(centres, bounds[:-1], bounds[1:], strict=True)
            if of_tap[:, a:b].any()
        ]
        local = np.interp(columns, [x for x, _ in known], [v for _, v in known])
        found[of_tap] = np.broadcast_to(local, variance.shape)[of_tap]
    return found
