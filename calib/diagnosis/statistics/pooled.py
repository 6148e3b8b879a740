"""Pooled statistics of a block: moments that need no pixel's own mean.

Each is a rate or a moment per sample, so that a few simulated lines and many recorded ones give
the same expected value.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.few_samples import lagged_covariance, pairs_of
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS, ResidualProducts

Floats = NDArray[np.float64]

ONSET_LINES = 3
"""The first lines of a block, whose means are looked at one by one."""

KINDS = (
    "variance",
    "kurtosis",
    *(f"columns_{k}" for k in range(1, COLUMN_LAGS + 1)),
    *(f"lines_{k}" for k in range(1, LINE_LAGS + 1)),
    "rows",
    "partners",
    "common",
    "common_taps",
    "common_1",
    "common_2",
)
"""Names of the statistics, in the order in which a block's vector holds them."""


@dataclass(frozen=True)
class Pooled:
    """One block's statistics by name.

    Attributes:
        of: Name to values; by group of pixels, by partner, or by tap.
    """

    of: dict[str, Floats]

    def vector(self) -> Floats:
        """Return all of them, in the order of `KINDS`."""
        return np.concatenate([self.of[kind] for kind in KINDS], axis=-1)


def places(sensor: Sensor) -> dict[str, slice]:
    """Return where each kind of pooled statistic stands in a block's vector."""
    sizes = dict.fromkeys(KINDS, sensor.n_groups)
    sizes |= {"partners": len(sensor.partner), "common": sensor.n_taps}
    sizes |= {"common_taps": 1, "common_1": 1, "common_2": 1}
    found, start = {}, 0
    for kind in KINDS:
        found[kind] = slice(start, start + sizes[kind])
        start += sizes[kind]
    return found


def pooled(  # noqa: PLR0917 - all that they depend on
    products: ResidualProducts,
    n: int,
    variance: Floats,
    sensor: Sensor,
    counts: Counts,
    first: int | None = None,
) -> Pooled:
    """Return a block's statistics; several blocks of `n` lines stand along a first axis of all.

    Args:
        products: Of a block's residuals.
        n: Lines.
        variance: What is expected of each pixel, DN^2.
        sensor: The sensor.
        counts: Its counts.
        first: Lines in which a step from the block before may show, whose common noise is left
            out; as many as `settled` tells where None.
    """
    size = counts.smallest_tap
    some = np.maximum(counts.pixels, 1.0)
    freedom = (n - 1) * (1.0 - 1.0 / size)
    of = {
        "variance": grouped(products.squares, sensor) / freedom / some,
        "kurtosis": _kurtosis(products, n, freedom, variance, sensor),
        "rows": grouped(products.rows, sensor) / (n - 1) / np.maximum(counts.rows, 1.0),
        "partners": products.partners.sum(axis=(-2, -1))
        / (n - 1)
        / np.maximum(counts.partners, 1.0),
        **_common(products.line_means, n - settled(n) if first is None else first, counts),
    }
    for k in range(COLUMN_LAGS):
        total = grouped(products.columns[..., k, :, :], sensor) / (n - 1)
        of[f"columns_{k + 1}"] = total / np.maximum(counts.columns[k], 1.0)
    for k in range(LINE_LAGS):
        total = grouped(products.lines[..., k, :, :], sensor) / pairs_of(n, k + 1)
        of[f"lines_{k + 1}"] = total / some
    return Pooled(of)


def _kurtosis(
    products: ResidualProducts, n: int, freedom: float, variance: Floats, sensor: Sensor
) -> Floats:
    """Return a third of the fourth cumulant over what is expected of variances squared."""
    expected = np.maximum(grouped(variance, sensor), 1e-300)
    ratio = grouped(products.squares, sensor) / freedom / expected
    fourth = grouped(products.fourths, sensor) / n / 3.0
    level = np.maximum(grouped(variance**2, sensor), 1e-300) * (freedom / n) ** 2
    return np.asarray(fourth / level - 2.0 * ratio + 1.0)


def settled(n: int) -> int:
    """Return how many of a block's `n` lines its common noise is told from."""
    return n - ONSET_LINES if n >= 4 * ONSET_LINES else n


def _common(line_means: Floats, first: int, counts: Counts) -> dict[str, Floats]:
    """Return variances and covariances of what a line's pixels have in common.

    Lines of a line sensor are compared with the next and the one after it. Of a frame, rows are
    compared with the next row, and the frame as a whole with the next frame. The first lines, where
    a step from the block before shows, are looked at elsewhere.
    """
    line_means = line_means[..., first:, :, :]
    n = line_means.shape[-3]
    centred = line_means - line_means.mean(axis=-3, keepdims=True)
    n_rows = centred.shape[-2]
    along = centred.sum(axis=-1) / counts.taps_of_row
    down = along.mean(axis=-1)
    if n_rows > 1:
        of_rows = (along[..., 1:] * along[..., :-1]).sum(axis=(-2, -1))
        lagged = [of_rows / ((n - 1) * (n_rows - 1)), lagged_covariance(down, 1)]
    else:
        lagged = [lagged_covariance(down, 1), lagged_covariance(down, 2)]
    cross = [
        (centred[..., a] * centred[..., b]).sum(axis=(-2, -1)) / ((n - 1) * rows)
        for (a, b), rows in counts.shared_rows.items()
    ]
    none = np.zeros_like(lagged[0])
    return {
        "common": (centred**2).sum(axis=(-3, -2)) / ((n - 1) * counts.present.sum(axis=0)),
        "common_taps": np.asarray(np.mean(cross, axis=0) if cross else none)[..., None],
        "common_1": np.asarray(lagged[0])[..., None],
        "common_2": np.asarray(lagged[1])[..., None],
    }
