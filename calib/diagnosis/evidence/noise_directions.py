"""What each tap's own gain and read noise absorb of the pooled variances."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.pooled import KINDS

Floats = NDArray[np.float64]


def noise_directions(
    std: Floats, baseline: Baseline, sensor: Sensor, counts: Counts
) -> tuple[Floats, ...]:
    """Return orthonormal whitened changes of pooled statistics, (n_blocks * n_pooled,) each.

    Args:
        std: Standard deviations of the pooled statistics, (n_blocks, n_pooled).
        baseline: As fitted.
        sensor: The sensor.
        counts: Of the sensor.
    """
    assert KINDS.index("variance") == 0  # noqa: S101 - variances stand first in the vector
    directions: list[Floats] = []
    groups = np.maximum(counts.pixels, 1.0)
    fine = np.isfinite(std) & (std > 0)
    for tap in range(sensor.n_taps):
        of_tap = (sensor.tap == tap).astype(np.float64)
        signal = of_tap * (baseline.mean_dn - baseline.offset_dn)
        for per_pixel in (signal, np.broadcast_to(of_tap, signal.shape)):
            change = np.zeros_like(std)
            change[:, : sensor.n_groups] = grouped(per_pixel, sensor) / groups
            white = np.where(fine, change / np.where(fine, std, 1.0), 0.0).ravel()
            length = float(white @ white)
            for direction in (*directions, *directions):
                white = white - direction * float(direction @ white)
            left = float(white @ white)
            if left > 1e-9 * max(length, 1e-300):
                directions.append(white / np.sqrt(left))
    return tuple(directions)
