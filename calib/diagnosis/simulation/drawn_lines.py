"""Statistics of a few drawn lines of all blocks."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.pooled import pooled
from calib.diagnosis.statistics.rare import RareEvents, rare_events, rare_trials
from calib.diagnosis.statistics.repeats import repeated_in_blocks
from calib.diagnosis.statistics.settled_mean import settled_mean
from calib.kernels.residual_products import ResidualProducts, stacked_products

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Drawn:
    """A few lines of all blocks.

    Attributes:
        products: Of blocks that have as many lines as each other, one entry for each number.
        blocks: Which blocks these are, likewise.
        n_lines: How many lines they have, likewise.
        events: What is counted in each block.
        drawn: Lines that were drawn of each block.
        ratio: Each pixel's variance over what is expected, (n_blocks, n_pixels).
    """

    products: tuple[ResidualProducts, ...]
    blocks: tuple[NDArray[np.intp], ...]
    n_lines: tuple[int, ...]
    events: tuple[RareEvents, ...]
    drawn: int
    ratio: Floats

    def pooled(self, variance: Floats, sensor: Sensor, counts: Counts) -> Floats:
        """Return the pooled statistics, (n_blocks, n_pooled).

        Args:
            variance: What is expected of each pixel, DN^2, (n_blocks, n_rows, n_columns).
            sensor: The sensor, whose noisy pixels are left out.
            counts: Its counts.
        """
        if sensor.noisy not in self._pooled:
            self._pooled[sensor.noisy] = self._in_groups(variance, sensor, counts)
        return self._pooled[sensor.noisy]

    def rare(self, sensor: Sensor) -> Floats:
        """Return rates of what is counted, (n_blocks, n_rare), noisy pixels' accidents left out."""
        if sensor.noisy not in self._rare:
            counts = np.stack([each.counts(sensor.noisy) for each in self.events])
            self._rare[sensor.noisy] = counts / rare_trials(self.drawn, sensor.n_pixels)
        return self._rare[sensor.noisy]

    @cached_property
    def _rare(self) -> dict[tuple[int, ...], Floats]:
        return {}

    @cached_property
    def _pooled(self) -> dict[tuple[int, ...], Floats]:
        return {}

    def _in_groups(self, variance: Floats, sensor: Sensor, counts: Counts) -> Floats:
        vectors = [
            pooled(each, n, variance[blocks], sensor, counts, first=0).vector()
            for each, blocks, n in zip(self.products, self.blocks, self.n_lines, strict=True)
        ]
        found = np.empty((len(variance), vectors[0].shape[-1]))
        for blocks, each in zip(self.blocks, vectors, strict=True):
            found[blocks] = each
        return found


def drawn_of(lines: Floats, chain: FittedChain, *, coded: bool) -> Drawn:
    """Return the statistics of `lines`, (n_blocks, n_lines, n_rows, n_columns).

    Of codes, lines that repeat the one before are counted and left out of all else.
    """
    sensor, variance = chain.sensor, chain.baseline.variance_dn2
    n_blocks, n = lines.shape[:2]
    again = np.zeros((n_blocks, n), bool)
    if coded:
        lines = np.clip(np.floor(lines + 0.5), 0, sensor.camera.full_scale_dn)
        again = repeated_in_blocks(lines)
    kept = n - again.sum(axis=1)
    ratio = np.zeros((n_blocks, sensor.n_pixels))
    events = [RareEvents.none()] * n_blocks
    counts, products, blocks = [], [], []
    for m in np.unique(kept):
        which = np.flatnonzero(kept == m)
        some = lines if m == n and len(which) == n_blocks else _without(lines, again, which)
        sigma = np.sqrt(variance[which])
        mean, found = _settled(some, sigma, sensor)
        counted = _rare(some, mean, sigma, found, n - int(m))
        for b, happened in zip(which.tolist(), counted, strict=True):
            events[b] = happened
        expected = variance[which] * max(m - 1, 1)
        ratio[which] = (found.squares / expected).reshape(len(which), -1)
        counts.append(int(m))
        products.append(found)
        blocks.append(which)
    return Drawn(
        tuple(products), tuple(blocks), tuple(counts),
        tuple(events), n, ratio,
    )  # fmt: skip


def _settled(lines: Floats, sigma: Floats, sensor: Sensor) -> tuple[Floats, ResidualProducts]:
    """Return pixels' means, DN, samples that stand out left out, and products about them.

    Args:
        lines: Of blocks, (n_blocks, n_lines, n_rows, n_columns).
        sigma: Standard deviation of each pixel's noise, DN, (n_blocks, n_rows, n_columns).
        sensor: The sensor.
    """
    mean, cut = lines.mean(axis=1), CUT_SIGMA * sigma + 1.0
    parts = (sensor.tap, sensor.n_taps, sensor.partner)
    found = stacked_products(lines, mean, cut, *parts)
    if found.outliers.any():
        each = zip(lines, mean, cut, found.outliers, strict=True)
        mean = np.stack([settled_mean(*block) for block in each])
        found = stacked_products(lines, mean, cut, *parts)
    return mean, found


def _without(lines: Floats, again: NDArray[np.bool_], which: NDArray[np.intp]) -> Floats:
    return np.stack([lines[b][~again[b]] for b in which])


def _rare(
    lines: Floats, mean: Floats, sigma: Floats, products: ResidualProducts, repeated: int
) -> list[RareEvents]:
    """Return what is counted in each block."""
    found = [RareEvents.none(repeated)] * len(lines)
    mean = mean + products.total / max(lines.shape[1], 1)
    for b in np.flatnonzero(products.outliers.any(axis=(1, 2))):
        found[b] = rare_events(lines[b], mean[b], sigma[b], products.outliers[b], repeated)
    return found
