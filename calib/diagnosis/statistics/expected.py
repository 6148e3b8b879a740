"""What pooled statistics of the plain model are, and how they scatter."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import STRETCHES, Sensor
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.few_samples import lagged_variance
from calib.diagnosis.statistics.pooled import Pooled, settled
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS

Floats = NDArray[np.float64]

FEWEST_LINES = 8
"""Fourth moments of residuals about fewer lines' own mean are not those of the samples."""
ROUNDED_DN2 = 0.6
"""Below this variance rounding makes fourth moments of its own."""


def expected(
    variance: Floats, kurtosis: Floats, n: int, sensor: Sensor, counts: Counts
) -> tuple[Pooled, Pooled]:
    """Return what the baseline expects of a block's statistics, and their standard deviations.

    Args:
        variance: Of each pixel, DN^2, (n_rows, n_columns).
        kurtosis: Fourth cumulant of each pixel, DN^4.
        n: Lines.
        sensor: The sensor.
        counts: Its counts.
    """
    some = np.maximum(counts.pixels, 1.0)
    v, v2, k4 = (grouped(x, sensor) / some for x in (variance, variance**2, kurtosis))
    mean = second_moments(variance, n, sensor, counts)
    mean["kurtosis"] = k4 / (3.0 * np.maximum(v2, 1e-300))
    phase = _rounding_error(v) / np.sqrt(2.0 * some)
    fourths = np.sqrt(24.0 / (n * some)) / 3.0
    std = {
        "variance": np.sqrt((2.0 * v2 / (n - 1) + k4 / n) / some + phase**2),
        "kurtosis": np.where((v < ROUNDED_DN2) | (n < FEWEST_LINES), np.inf, fourths),
        "rows": _std(v2, n, counts.rows) if sensor.n_rows > 1 else np.full_like(v, np.inf),
        "partners": np.sqrt(
            float((variance**2).mean()) / (n - 1) / np.maximum(counts.partners, 1.0)
        ),
        **_common_std(variance, settled(n), sensor, counts),
    }
    for k in range(COLUMN_LAGS):
        std[f"columns_{k + 1}"] = _std(v2, n, counts.columns[k])
    for k in range(LINE_LAGS):
        std[f"lines_{k + 1}"] = (
            np.sqrt(v2 * lagged_variance(n, k + 1) / some) if n > k + 2 else np.full_like(v, np.inf)
        )
    for kind in ("variance", "kurtosis"):
        std[kind] = np.where(counts.pixels == 0, np.inf, std[kind])
    return Pooled(mean), Pooled(std)


def _common_std(variance: Floats, n: int, sensor: Sensor, counts: Counts) -> dict[str, Floats]:
    """Return by how much statistics of what a line's pixels have in common scatter in `n` lines."""
    of_tap = _of_tap(variance, sensor, counts)
    spread = float(np.sqrt((of_tap**2).mean()))
    shared = np.array([1.0 / rows for rows in counts.shared_rows.values()] or [np.inf])
    of_row = float(of_tap.mean() / counts.taps_of_row)
    # Of what follows in time: a line of a line sensor, or a frame.
    whole = of_row / sensor.n_rows
    one, two = whole / np.sqrt(n), whole * np.sqrt(1.0 / n)
    if sensor.n_rows > 1:
        one, two = of_row / np.sqrt((n - 1) * sensor.n_rows), whole * np.sqrt(lagged_variance(n, 1))
    return {
        "common": np.sqrt(2.0 / ((n - 1) * counts.present.sum(axis=0))) * of_tap,
        "common_taps": np.full(1, spread * np.sqrt(shared.sum() / (n - 1)) / len(shared)),
        "common_1": np.full(1, one),
        "common_2": np.full(1, two),
    }


def second_moments(variance: Floats, n: int, sensor: Sensor, counts: Counts) -> dict[str, Floats]:
    """Return what a variance of each pixel makes of a block's statistics, by their names.

    All but kurtosis, which is 0, are linear in the variance.

    Args:
        variance: DN^2, (n_rows, n_columns), or a change of it.
        n: Lines.
        sensor: The sensor.
        counts: Its counts.
    """
    v, size = grouped(variance, sensor) / np.maximum(counts.pixels, 1.0), counts.smallest_tap
    taps = np.array([variance[sensor.tap == t].mean() for t in range(sensor.n_taps)])
    of_tap, of_group = _of_tap(variance, sensor, counts), taps.repeat(STRETCHES)
    # Residuals of a line of a line sensor, or of a frame, are about the block's own mean, and
    # covary by -1/n of it; rows of one frame do not.
    lagged = -of_tap.mean() / counts.taps_of_row / sensor.n_rows / settled(n)
    mean = {
        # Taking off a line's mean mixes a pixel's variance with those of its tap.
        "variance": (v * (1.0 - 2.0 / size) + of_group / size) / (1.0 - 1.0 / size),
        "kurtosis": np.zeros_like(v),
        "rows": np.zeros_like(v),
        "partners": np.zeros(len(sensor.partner)),
        "common": of_tap,
        "common_taps": np.zeros(1),
        "common_1": np.full(1, lagged if sensor.n_rows == 1 else 0.0),
        "common_2": np.full(1, lagged),
    }
    for k in range(COLUMN_LAGS):
        mean[f"columns_{k + 1}"] = (of_group - 2.0 * v) * counts.same_tap[k] / size
    for k in range(LINE_LAGS):
        mean[f"lines_{k + 1}"] = -v / n * (1.0 - 1.0 / size)
    return mean


def _of_tap(variance: Floats, sensor: Sensor, counts: Counts) -> Floats:
    """Return the variance of each tap's mean in a line, (n_taps,)."""
    taps = np.array([variance[sensor.tap == t].mean() for t in range(sensor.n_taps)])
    return np.asarray(taps / (counts.tap_size.sum(axis=0) / counts.present.sum(axis=0)))


def _rounding_error(variance: Floats) -> Floats:
    """Return the amplitude with which rounding's variance swings about 1/12 with the mean's phase.

    Source: Widrow and Kollar, Quantization Noise (2008), the first term of the series.
    """
    before = np.maximum(variance - 1.0 / 12.0, 0.0)
    return np.asarray((4.0 * before + 1.0 / np.pi**2) * np.exp(-2.0 * np.pi**2 * before))


def _std(v2: Floats, n: int, pairs: Floats) -> Floats:
    return np.where(pairs > 0, np.sqrt(v2 / (n - 1) / np.maximum(pairs, 1.0)), np.inf)
