"""Pooled statistics of a block: moments that need no pixel's own mean.

Each is a rate or a moment per sample, so that a few simulated lines and many recorded ones give
the same expected value.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.few_samples import lagged_variance
from calib.diagnosis.sensor import STRETCHES, Sensor
from calib.kernels.residual_products import COLUMN_LAGS, LINE_LAGS, ResidualProducts, tap_sizes

Floats = NDArray[np.float64]

ONSET_LINES = 3
"""The first lines of a block, whose means are looked at one by one."""

FEWEST_LINES = 8
"""Fourth moments of residuals about fewer lines' own mean are not those of the samples."""
ROUNDED_DN2 = 0.6
"""Below this variance rounding makes fourth moments of its own."""

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


@dataclass(frozen=True)
class Counts:
    """How much is averaged in each statistic; depends on the sensor alone."""

    pixels: Floats
    columns: Floats
    same_tap: Floats
    rows: Floats
    partners: Floats
    tap_size: Floats

    @property
    def present(self) -> NDArray[np.bool_]:
        """Which taps a row has, (n_rows, n_taps): of four quadrants, two."""
        return np.asarray(self.tap_size > 0)

    @property
    def smallest_tap(self) -> float:
        """How many pixels of a row share a tap, at least 2."""
        return max(float(self.tap_size[self.present].min()), 2.0)

    @property
    def taps_of_row(self) -> float:
        """How many taps a row has."""
        return float(self.present.sum(axis=1).mean())

    @property
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


def grouped(values: Floats, sensor: Sensor) -> Floats:
    """Return sums over each group of pixels, (..., n_groups), of (..., n_rows, n_columns)."""
    flat = values.reshape(*values.shape[:-2], sensor.n_pixels)
    # A few columns only: threads of a matrix product would take longer to start.
    return np.asarray(np.einsum("...p,pg->...g", flat, sensor.members))


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
    ratio = (
        grouped(products.squares, sensor) / freedom / np.maximum(grouped(variance, sensor), 1e-300)
    )
    fourth = grouped(products.fourths, sensor) / n / 3.0
    level = np.maximum(grouped(variance**2, sensor), 1e-300) * (freedom / n) ** 2
    of = {
        "variance": grouped(products.squares, sensor) / freedom / some,
        "kurtosis": fourth / level - 2.0 * ratio + 1.0,
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
        of[f"lines_{k + 1}"] = (
            grouped(products.lines[..., k, :, :], sensor) / max(n - 1 - k, 1) / some
        )
    return Pooled(of)


def settled(n: int) -> int:
    """Return how many of a block's `n` lines its common noise is told from."""
    return n - ONSET_LINES if n >= 4 * ONSET_LINES else n


def _common(line_means: Floats, first: int, counts: Counts) -> dict[str, Floats]:
    """Return variances and covariances of what a line's pixels have in common.

    The first lines, where a step from the block before shows, are looked at elsewhere.
    """
    line_means = line_means[..., first:, :, :]
    n = line_means.shape[-3]
    centred = line_means - line_means.mean(axis=-3, keepdims=True)
    n_rows = centred.shape[-2]
    # Rows of a frame, lines of a line sensor follow each other.
    along, pairs = np.moveaxis(centred.sum(axis=-1) / counts.taps_of_row, -2, -1), [n - 1, n_rows]
    if n_rows > 1:
        along = np.swapaxes(along, -2, -1)
    else:
        pairs = [1, n]
    lagged = [
        (along[..., k:] * along[..., :-k]).sum(axis=(-2, -1)) / max(pairs[0] * (pairs[1] - k), 1)
        for k in (1, 2)
    ]
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
    size = counts.smallest_tap
    v = grouped(variance, sensor) / some
    v2 = grouped(variance**2, sensor) / some
    k4 = grouped(kurtosis, sensor) / some
    taps = np.array([variance[sensor.tap == t].mean() for t in range(sensor.n_taps)])
    rows_of_tap = counts.present.sum(axis=0)
    of_tap = taps / (counts.tap_size.sum(axis=0) / rows_of_tap)
    spread = float(np.sqrt((of_tap**2).mean()))
    kept = settled(n)
    # Rows of a frame are about their own means over the frames, lines about none of their own.
    lines = kept if sensor.n_rows == 1 else (kept - 1) * sensor.n_rows
    tap_of_group = np.arange(sensor.n_groups) // STRETCHES
    # Taking off a line's mean mixes a pixel's variance with those of its tap.
    own = (v * (1.0 - 2.0 / size) + taps[tap_of_group] / size) / (1.0 - 1.0 / size)
    phase = _rounding_error(v) / np.sqrt(2.0 * some)
    mean = {
        "variance": own,
        "kurtosis": k4 / (3.0 * np.maximum(v2, 1e-300)),
        "rows": np.zeros_like(v),
        "partners": np.zeros(len(sensor.partner)),
        "common": of_tap,
        "common_taps": np.zeros(1),
        "common_1": np.zeros(1)
        if sensor.n_rows > 1
        else np.full(1, -of_tap.mean() / sensor.n_taps / kept),
        "common_2": np.zeros(1)
        if sensor.n_rows > 1
        else np.full(1, -of_tap.mean() / sensor.n_taps / kept),
    }
    shared = np.array([1.0 / rows for rows in counts.shared_rows.values()] or [np.inf])
    std = {
        "variance": np.sqrt((2.0 * v2 / (n - 1) + k4 / n) / some + phase**2),
        "kurtosis": np.where(
            (v < ROUNDED_DN2) | (n < FEWEST_LINES), np.inf, np.sqrt(24.0 / (n * some)) / 3.0
        ),
        "rows": _std(v2, n, counts.rows),
        "partners": np.sqrt(
            float((variance**2).mean()) / (n - 1) / np.maximum(counts.partners, 1.0)
        ),
        "common": np.sqrt(2.0 / ((kept - 1) * rows_of_tap)) * of_tap,
        "common_taps": np.full(1, spread * np.sqrt(shared.sum() / (kept - 1)) / len(shared)),
        "common_1": np.full(1, of_tap.mean() / counts.taps_of_row / np.sqrt(lines)),
        "common_2": np.full(1, of_tap.mean() / counts.taps_of_row / np.sqrt(lines)),
    }
    if sensor.n_rows == 1:
        std["rows"] = np.full_like(v, np.inf)
    for k in range(COLUMN_LAGS):
        mean[f"columns_{k + 1}"] = (taps[tap_of_group] - 2.0 * v) * counts.same_tap[k] / size
        std[f"columns_{k + 1}"] = _std(v2, n, counts.columns[k])
    for k in range(LINE_LAGS):
        mean[f"lines_{k + 1}"] = -v / n * (1.0 - 1.0 / size)
        std[f"lines_{k + 1}"] = (
            np.sqrt(v2 * lagged_variance(n, k + 1) / some) if n > k + 2 else np.full_like(v, np.inf)
        )
    empty = counts.pixels == 0
    for kind in ("variance", "kurtosis"):
        std[kind] = np.where(empty, np.inf, std[kind])
    return Pooled(mean), Pooled(std)


def _rounding_error(variance: Floats) -> Floats:
    """Return the amplitude with which rounding's variance swings about 1/12 with the mean's phase.

    Source: Widrow and Kollar, Quantization Noise (2008), the first term of the series.
    """
    before = np.maximum(variance - 1.0 / 12.0, 0.0)
    return np.asarray((4.0 * before + 1.0 / np.pi**2) * np.exp(-2.0 * np.pi**2 * before))


def _std(v2: Floats, n: int, pairs: Floats) -> Floats:
    return np.where(pairs > 0, np.sqrt(v2 / (n - 1) / np.maximum(pairs, 1.0)), np.inf)
