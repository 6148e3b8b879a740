"""A recording's statistics against the baseline, whitened: what is looked for signatures in."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.code_counts import CodeCounts
from calib.diagnosis.baseline.expected_codes import saturated_blocks, stopped_blocks
from calib.diagnosis.baseline.nuisance import scene_blocks
from calib.diagnosis.evidence.growing import Growing
from calib.diagnosis.evidence.mean_space import MeanSpace
from calib.diagnosis.evidence.onset import onset_seen, onset_std
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.pooled_space import PooledSpace
from calib.diagnosis.evidence.rare_space import RareSpace
from calib.diagnosis.evidence.recorded_means import space_of_means
from calib.diagnosis.evidence.standing_out import PixelMisfits, excess_variance
from calib.diagnosis.evidence.tone_scale import ToneScale
from calib.diagnosis.evidence.whitening import Whitening
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.monitor import MonitorReadings, readings_of
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.common_noise import CommonNoise
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.further_tones import FurtherTone, further_tones
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.tones import find_peaks

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Evidence:
    """What was recorded, the baseline fitted to it, and how to weigh differences.

    Attributes:
        sums: Of the blocks.
        table: Their conditions.
        sensor: The sensor.
        baseline: As fitted.
        counts: Of the sensor.
        common: Noise that a line's pixels share.
        kept: Blocks that count, where some are left out.
        whole: The space of the means of all pixels, where noisy ones are left out of `space`.
        known_peaks: Of the spectra, where they have been looked for.
        growing: Pixels that grow with the exposure: their means count, at a variance of their own.
        of_all: The evidence of all blocks, where some are left out: what it knows holds here, too.
    """

    sums: tuple[BlockSums, ...]
    table: ConditionsTable
    sensor: Sensor
    baseline: Baseline
    counts: Counts
    common: CommonNoise
    whole: MeanSpace | None = None
    kept: NDArray[np.bool_] | None = None
    known_peaks: tuple[Peak, ...] | None = None
    growing: Growing | None = None
    of_all: "Evidence | None" = None

    @property
    def n_blocks(self) -> int:
        """How many blocks there are."""
        return len(self.sums)

    @cached_property
    def n(self) -> Floats:
        """Lines of each block."""
        return np.array([each.n_lines for each in self.sums], np.float64)

    @property
    def saturated(self) -> NDArray[np.bool_]:
        """Which blocks, (n_blocks,), have wells or codes that are full."""
        return saturated_blocks(self.baseline)

    @cached_property
    def space(self) -> MeanSpace:
        """The space of the means."""
        return space_of_means(
            self.sums, self.table, self.sensor, self.baseline, self.counts,
            common=self.common, growing=self.growing,
        )  # fmt: skip

    @cached_property
    def pooled(self) -> PooledSpace:
        """The space of the pooled statistics."""
        scenes = scene_blocks(self.table)
        return PooledSpace(
            self.sums, self.sensor, self.baseline, self.counts, self.common, self.rare_space,
            scenes, self.kept, None if self.of_all is None else self.of_all.pooled,
        )  # fmt: skip

    @cached_property
    def rare_space(self) -> RareSpace:
        """Where rare events are counted."""
        if self.of_all is not None:
            return self.of_all.rare_space
        counts = np.stack([each.events.counts(self.sensor.noisy) for each in self.sums])
        variance = self.baseline.variance_dn2.mean(axis=(1, 2))
        stopped = stopped_blocks(self.baseline)
        return RareSpace.of(counts, self.n, self.sensor.n_pixels, variance, stopped)

    @cached_property
    def code_counts(self) -> CodeCounts:
        """What the histogram of codes is compared with: it knows nothing of lines."""
        shared = [self.common.shared_dn2(float(signal)) for signal in self.signal_dn]
        variance = self.baseline.variance_dn2 + np.reshape(shared, (-1, 1, 1))
        return CodeCounts.of(self.sums, replace(self.baseline, variance_dn2=variance))

    @cached_property
    def monitor(self) -> MonitorReadings:
        """What the monitor read."""
        return readings_of(self.table)

    def observed(self) -> Change:
        """Return the differences of what was recorded from what the baseline expects."""
        return self._observed

    @cached_property
    def _observed(self) -> Change:
        return Change(
            self.observed_means, onset_seen(self.sums, self.sensor), self.pooled.observed,
            self.rare_space.seen,
            excess_variance(self.sums, self.baseline, self.counts),
            self.code_counts.residual(),
            self._tone_scale.observed_dn2,
            self.misfit(self.observed_means, observed=True),
            self.monitor.observed,
        )  # fmt: skip

    @cached_property
    def observed_means(self) -> Floats:
        """Means less those of the baseline, DN, (n_blocks, n_pixels)."""
        means = np.stack([each.mean_dn.ravel() for each in self.sums])
        return np.asarray(means - self.baseline.mean_dn.reshape(means.shape))

    @cached_property
    def whitening(self) -> Whitening:
        """How changes are weighed."""
        return Whitening(
            self.n, self.space, self.pooled, self.onset_std, self.rare_space, self._tone_scale,
            self.code_counts if self.kept is None else None, self.monitor, self.kept,
        )  # fmt: skip

    def point(self, change: Change) -> Point:
        """Return a change in the whitened space, without what the baseline absorbs."""
        return self.whitening.point(change)

    def product(self, one: Point, other: Point) -> float:
        """Return the inner product."""
        return self.whitening.product(one, other)

    def without_blocks(self, blocks: NDArray[np.intp]) -> "Evidence":
        """Return the evidence of the other blocks, statistics of all blocks together left out."""
        kept = np.ones(self.n_blocks, bool)
        kept[blocks] = False
        baseline = replace(self.baseline, usable=self.baseline.usable & kept[:, None, None])
        return replace(
            self, baseline=baseline, kept=kept, whole=None, known_peaks=self.peaks, of_all=self
        )

    @cached_property
    def signal_dn(self) -> Floats:
        """Mean signal of each block, (n_blocks,)."""
        return np.asarray((self.baseline.mean_dn - self.baseline.offset_dn).mean(axis=(1, 2)))

    @cached_property
    def peaks(self) -> tuple[Peak, ...]:
        """Tones that stand out of the spectra."""
        known = self.known_peaks
        return find_peaks(self.sums, self.signal_dn) if known is None else known

    @cached_property
    def further_tones(self) -> tuple[FurtherTone, ...]:
        """What goes round in the lines' means beside the peaks."""
        return further_tones(self.sums, self.sensor, self.signal_dn, self.peaks)

    @cached_property
    def _tone_scale(self) -> ToneScale:
        return ToneScale.of(self.peaks, self.n_blocks)

    @cached_property
    def onset_std(self) -> Floats:
        """Standard deviations of the first lines' means, (n_blocks, ONSET_LINES)."""
        if self.of_all is not None:
            return self.of_all.onset_std
        return onset_std(self.sums, self.baseline, self.sensor, self.common)

    def misfit(self, means: Floats, *, observed: bool) -> Floats:
        """Return by how many standard deviations each pixel's means, DN, miss the baseline."""
        return self._misfits.sigma(means, observed=observed)

    @cached_property
    def _misfits(self) -> PixelMisfits:
        return PixelMisfits.of(self.whole or self.space, self.table.exposure_us)
