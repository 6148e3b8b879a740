"""How much is averaged in pooled statistics: pixels, pairs of them, and taps of a row."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.kernels.group_sums import group_sums
from calib.kernels.residual_products import COLUMN_LAGS, tap_sizes

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Counts:
    """How much is averaged in each statistic; depends on the sensor alone."""

    pixels: Floats
    columns: Floats
    same_tap: Floats
    rows: Floats
    partners: Floats
    tap_size: Floats

    @cached_property
    def present(self) -> NDArray[np.bool_]:
        """Which taps a row has, (n_rows, n_taps): of four quadrants, two."""
        return np.asarray(self.tap_size > 0)

    @cached_property
    def smallest_tap(self) -> float:
        """How many pixels of a row share a tap, at least 2."""
        return max(float(self.tap_size[self.present].min()), 2.0)

    @cached_property
    def taps_of_row(self) -> float:
        """How many taps a row has."""
        return float(self.present.sum(axis=1).mean())

    @cached_property
    def shared_rows(self) -> dict[tuple[int, int], int]:
        """In how many rows two taps stand together, of those that do."""
        n_taps = self.present.shape[1]
        pairs = [(a, b) for a in range(n_taps) for b in range(a + 1, n_taps)]
        rows = {(a, b): int((self.present[:, a] & self.present[:, b]).sum()) for a, b in pairs}
        return {pair: n for pair, n in rows.items() if n > 0}

    @classmethod
    def of(cls, sensor: Sensor) -> "Counts":
        """Return the counts of `sensor`."""
        every = np.ones((sensor.n_rows, sensor.n_columns))
        columns, same = [], []
        for k in range(1, COLUMN_LAGS + 1):
            pair = every.copy()
            pair[:, max(sensor.n_columns - k, 0) :] = 0.0
            alike = pair * (sensor.tap == np.roll(sensor.tap, -k, axis=1))
            columns.append(grouped(pair, sensor))
            same.append(grouped(alike, sensor) / np.maximum(columns[-1], 1.0))
        below = every.copy()
        below[-1] = 0.0
        return cls(
            grouped(every, sensor),
            np.stack(columns),
            np.stack(same),
            grouped(below, sensor),
            np.array([(p >= 0).sum() * sensor.n_rows for p in sensor.partner], np.float64),
            tap_sizes(sensor.tap, sensor.n_taps),
        )


def grouped(values: Floats, sensor: Sensor) -> Floats:
    """Return sums over each group of pixels, (..., n_groups), of (..., n_rows, n_columns)."""
    leading = values.shape[:-2]
    sums = group_sums(values.reshape(-1, sensor.n_pixels), sensor.group.ravel(), sensor.n_groups)
    return sums.reshape(*leading, sensor.n_groups)
