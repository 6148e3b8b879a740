"""The first lines of a block: what is left of the block before."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.common_noise import CommonNoise
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.diagnosis.statistics.whole_lines import whole_lines

Floats = NDArray[np.float64]


def onset_seen(sums: Sequence[BlockSums], sensor: Sensor) -> Floats:
    """Return the first lines' means less those of the later half, DN, (n_blocks, ONSET_LINES)."""
    onset = np.zeros((len(sums), ONSET_LINES))
    for b, each in enumerate(sums):
        line = whole_lines(each, sensor)
        k = min(ONSET_LINES, len(line) // 2)
        onset[b, :k] = line[:k] - line[len(line) // 2 :].mean()
    return onset


def onset_std(
    sums: Sequence[BlockSums], baseline: Baseline, sensor: Sensor, common: CommonNoise
) -> Floats:
    """Return its standard deviations, (n_blocks, ONSET_LINES); inf: no block before, few lines."""
    std = np.full((len(sums), ONSET_LINES), np.inf)
    for b, each in list(enumerate(sums))[1:]:
        signal = float((baseline.mean_dn[b] - baseline.offset_dn).mean())
        white = float(baseline.variance_dn2[b].mean()) / sensor.n_pixels
        shared = common.shared_dn2(signal) + common.of_taps_dn2 / sensor.n_taps
        shared *= common.of_mean_of_rows(sensor.n_rows)
        if each.n_lines >= 2 * ONSET_LINES:
            std[b] = np.sqrt((white + shared) * (1.0 + 2.0 / each.n_lines))
    return std
