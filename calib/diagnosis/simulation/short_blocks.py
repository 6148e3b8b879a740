"""What a few simulated lines get wrong of covariances between lines, against many recorded ones.

Residuals about a block's own mean covary by -v/n where lines of variance v are independent. That is
little in a recorded block, and a lot in the few lines that stand for it: unless it is taken back,
any change of the variance looks as if neighbouring lines had begun to covary.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.pooled import places, settled
from calib.kernels.residual_products import LINE_LAGS

Floats = NDArray[np.float64]


def as_of_long_blocks(
    pooled: Floats, n: int, recorded: Floats, sensor: Sensor, counts: Counts
) -> Floats:
    """Return changes of pooled statistics as blocks of `recorded` lines would show them.

    Args:
        pooled: Changes seen in `n` lines of each block, (n_blocks, n_pooled).
        n: Lines that were simulated.
        recorded: Lines of each block, (n_blocks,).
        sensor: The sensor.
        counts: Its counts.
    """
    found, where = pooled.copy(), places(sensor)
    for k in range(1, LINE_LAGS + 1):
        # n - k products of mean -v/n are divided by n - k.
        bias = 1.0 / n - 1.0 / recorded
        found[:, where[f"lines_{k}"]] += bias[:, None] * pooled[:, where["variance"]]
    bias = 1.0 / n - 1.0 / np.array([settled(int(m)) for m in recorded])
    in_time = ("common_1", "common_2") if sensor.n_rows == 1 else ("common_2",)
    for kind in in_time:
        found[:, where[kind]] += (bias * _of_whole(pooled, sensor, counts))[:, None]
    return found


def _of_whole(pooled: Floats, sensor: Sensor, counts: Counts) -> Floats:
    """Return the variance of the mean of a line, or of a frame, (n_blocks,)."""
    where, taps, rows = places(sensor), counts.taps_of_row, sensor.n_rows
    of_row = pooled[:, where["common"]].mean(axis=1) / taps
    of_row = of_row + pooled[:, where["common_taps"]][:, 0] * (taps - 1) / taps
    if rows == 1:
        return np.asarray(of_row)
    return np.asarray(of_row / rows + pooled[:, where["common_1"]][:, 0] * (rows - 1) / rows)
