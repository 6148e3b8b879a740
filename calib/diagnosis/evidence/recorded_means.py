"""How the means of a recording are weighed: by the scatter of its samples and of its lines."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.nuisance import regressors
from calib.diagnosis.evidence.growing import Growing
from calib.diagnosis.evidence.mean_space import MeanSpace, mean_space
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.common_noise import CommonNoise
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.recorded_scatter import wider
from calib.rounding import mean_square_bias

Floats = NDArray[np.float64]


def space_of_means(
    sums: Sequence[BlockSums],
    table: ConditionsTable,
    sensor: Sensor,
    baseline: Baseline,
    counts: Counts,
    *,
    common: CommonNoise,
    growing: Growing | None,
) -> MeanSpace:
    """Return the space of the means.

    Args:
        sums: Of the blocks.
        table: The blocks' conditions.
        sensor: The sensor.
        baseline: As fitted.
        counts: Of the sensor.
        common: Noise that a line's pixels share.
        growing: Pixels that grow with the exposure: they count, at a variance of their own.
    """
    n = np.array([each.n_lines for each in sums], np.float64)
    variance, noisy = _recorded_variance(sums, baseline, sensor, counts), set(sensor.noisy)
    if growing is not None:
        variance[:, growing.pixels] = growing.variance_dn2
        noisy -= set(growing.pixels.tolist())
    sampling = variance / n[:, None] + mean_square_bias(
        np.sqrt(np.maximum(variance - 1.0 / 12.0, 0.0))
    )
    usable = baseline.usable.reshape(len(sums), -1)
    weight = np.where(usable, 1.0 / np.sqrt(sampling), 0.0)
    weight[:, sorted(noisy)] = 0.0
    signal = (baseline.mean_dn - baseline.offset_dn).reshape(len(sums), -1)
    per_block = common.memory / (n * sensor.n_rows)
    modes = [np.ones_like(signal), signal]
    strength = [common.fixed_dn2 * per_block, common.relative * per_block]
    of_taps = np.stack([common.tap_mean_dn2(each, counts.present) for each in n])
    for tap in range(sensor.n_taps if common.of_taps_dn2 > 0.0 else 0):
        modes.append(np.ones_like(signal) * (sensor.tap.ravel() == tap))
        strength.append(of_taps[:, tap])
    block = np.tile(np.arange(len(n)), len(modes))
    return mean_space(
        weight,
        regressors(table, signal.shape),
        np.concatenate(modes),
        block,
        np.concatenate(strength),
    )


def _recorded_variance(
    sums: Sequence[BlockSums], baseline: Baseline, sensor: Sensor, counts: Counts
) -> Floats:
    """Return that of each pixel's samples, DN^2, (n_blocks, n_pixels): the baseline's, or more."""
    group = np.minimum(sensor.group, sensor.n_groups - 1)
    some = np.maximum(counts.pixels, 1.0)
    variance = baseline.variance_dn2
    factors = [
        wider(each, grouped(v, sensor) / some, sensor, counts)[group]
        for each, v in zip(sums, variance, strict=True)
    ]
    return np.asarray((variance * np.stack(factors)).reshape(len(sums), -1))
