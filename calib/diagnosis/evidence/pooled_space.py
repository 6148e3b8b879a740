"""The space of pooled statistics: what the baseline expects of them, and how they scatter."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.expected_codes import saturated_blocks
from calib.diagnosis.evidence.noise_directions import noise_directions
from calib.diagnosis.evidence.rare_space import RareSpace
from calib.diagnosis.evidence.shared_noise import SharedNoise
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.common_noise import CommonNoise
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.expected import expected
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.pooled import Pooled, places, pooled
from calib.diagnosis.statistics.recorded_scatter import as_recorded

Floats = NDArray[np.float64]

NEAR_EVENTS = 3.0
"""So many samples nearly stand out for each that does."""
LEAST_EVENTS = 0.5
"""Of them in a group of pixels and a block: one more or less is no sign of anything."""
SHARED_KINDS = ("common", "common_taps", "common_1", "common_2")
"""Statistics of what a line's pixels have in common, side by side in a block's vector."""


@dataclass(frozen=True)
class PooledSpace:
    """Where pooled statistics are whitened.

    Attributes:
        sums: Of the blocks.
        sensor: The sensor.
        baseline: As fitted.
        counts: Of the sensor.
        common: Noise that a line's pixels share.
        events: Where rare events are counted.
        scenes: Which blocks, (n_blocks,), show a scene.
        kept: Blocks that count, where some are left out.
        of_all: The space of all blocks, where some are left out: what it knows holds here, too.
    """

    sums: Sequence[BlockSums]
    sensor: Sensor
    baseline: Baseline
    counts: Counts
    common: CommonNoise
    events: RareSpace
    scenes: NDArray[np.bool_]
    kept: NDArray[np.bool_] | None = None
    of_all: "PooledSpace | None" = None

    @cached_property
    def places(self) -> dict[str, slice]:
        """Where each kind of pooled statistic stands in a block's vector."""
        return places(self.sensor)

    @cached_property
    def n(self) -> Floats:
        """Lines of each block."""
        return np.array([each.n_lines for each in self.sums], np.float64)

    @cached_property
    def expected(self) -> tuple[tuple[Pooled, Pooled], ...]:
        """Each block's pooled statistics as the baseline expects them, and their deviations."""
        if self.of_all is not None:
            return self.of_all.expected
        pairs = []
        gain = self.baseline.gain_dn_per_e[self.sensor.tap]
        for each, n, signal, variance in zip(
            self.sums, self.n, self._signal_dn, self.baseline.variance_dn2, strict=True
        ):
            pair = expected(variance, gain**3 * signal, int(n), self.sensor, self.counts)
            raised = self._shared_noise(float(signal.mean()), pair[0].of["common"]).growth()
            n_taps = self.sensor.n_taps
            pair[1].of["common"] *= raised[:n_taps]
            for kind, factor in zip(SHARED_KINDS[1:], raised[n_taps:], strict=True):
                pair[1].of[kind] *= factor
            level = pair[0].of["variance"]
            std = as_recorded(each, level, pair[1], self.sensor, self.counts)
            pairs.append((pair[0], std))
        return tuple(pairs)

    @cached_property
    def observed(self) -> Floats:
        """Pooled statistics less those that the baseline expects, (n_blocks, n_pooled)."""
        if self.of_all is not None:
            return self.of_all.observed
        vectors = []
        for b, each in enumerate(self.sums):
            variance = self.baseline.variance_dn2[b]
            values = pooled(each.products, each.n_lines, variance, self.sensor, self.counts)
            vectors.append(values.vector() - self.expected[b][0].vector())
        return np.stack(vectors)

    @cached_property
    def std(self) -> Floats:
        """Standard deviations of the pooled statistics, (n_blocks, n_pooled); inf: not used."""
        if self.of_all is not None and self.kept is not None:
            return np.where(self.kept[:, None], self.of_all.std, np.inf)
        std = np.stack([std.vector() for _, std in self.expected])
        # The noise of pixels side by side in bright and dark parts has no common level.
        std[self.scenes] = np.inf
        where = self.places["kurtosis"]
        std[:, where] = np.hypot(std[:, where], self._fourths_of_events())
        # Where wells or codes are full, noise is not the light's.
        std[saturated_blocks(self.baseline)] = np.inf
        return std

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """Which pooled statistics tell anything, (n_blocks, n_pooled)."""
        return np.isfinite(self.std) & (self.std > 0)

    def over_std(self, change: Floats) -> Floats:
        """Return changes, (n_blocks, n_pooled), in standard deviations of their own."""
        return np.where(self.used, change / np.where(self.used, self.std, 1.0), 0.0)

    def whitened(self, change: Floats) -> Floats:
        """Return changes, (n_blocks, n_pooled), without what gain and read noise absorb, flat."""
        white = self.over_std(change)
        where = slice(self.places[SHARED_KINDS[0]].start, self.places[SHARED_KINDS[-1]].stop)
        white[:, where] = np.einsum("bij,bj->bi", self.whiteners, white[:, where])
        flat = white.ravel()
        for direction in self._noise_directions:
            flat = flat - direction * float(direction @ flat)
        return flat

    @property
    def _signal_dn(self) -> Floats:
        """Each pixel's signal, (n_blocks, n_rows, n_columns)."""
        return np.maximum(self.baseline.mean_dn - self.baseline.offset_dn, 0.0)

    def _shared_noise(self, signal_dn: float, white: Floats) -> SharedNoise:
        common = self.common
        shared = common.shared_dn2(signal_dn)
        return SharedNoise(self.counts, white, shared, common.rows_share, common.of_taps_dn2)

    @cached_property
    def whiteners(self) -> Floats:
        """What makes statistics of common noise independent, (n_blocks, n, n)."""
        if self.of_all is not None:
            return self.of_all.whiteners
        signal = (self.baseline.mean_dn - self.baseline.offset_dn).mean(axis=(1, 2))
        return np.stack(
            [
                self._shared_noise(max(float(s), 0.0), mean.of["common"]).whitener()
                for s, (mean, _) in zip(signal, self.expected, strict=True)
            ]
        )

    @cached_property
    def _noise_directions(self) -> tuple[Floats, ...]:
        """Whitened changes of the pooled variances with each tap's gain and read noise."""
        return noise_directions(self.std, self.baseline, self.sensor, self.counts)

    def _fourths_of_events(self) -> Floats:
        """Return by how much kurtosis scatters with single samples that nearly stand out.

        Each of them has the fourth power of up to the cut at which samples are counted instead.
        """
        sigma = np.sqrt(self.baseline.variance_dn2.mean(axis=(1, 2)))[:, None]
        samples = np.maximum(self.n[:, None] * self.counts.pixels, 1.0)
        events = LEAST_EVENTS + NEAR_EVENTS * self.events.rate[:, None] * samples
        return np.asarray((CUT_SIGMA + 1.0 / sigma) ** 4 / (3.0 * samples) * np.sqrt(events))
