"""A recording's statistics against the baseline, whitened: what is looked for signatures in."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.code_counts import CodeCounts, saturated_blocks
from calib.diagnosis.baseline.nuisance import regressors, scene_blocks
from calib.diagnosis.evidence.growing import Growing
from calib.diagnosis.evidence.mean_space import MeanSpace, mean_space
from calib.diagnosis.evidence.onset import onset_seen, onset_std
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.pooled_space import PooledSpace
from calib.diagnosis.evidence.rare_space import RareSpace
from calib.diagnosis.evidence.standing_out import N_STEPS, PixelMisfits, held_slopes, steps
from calib.diagnosis.evidence.tone_scale import ToneScale
from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.diagnosis.recorded.monitor import MonitorReadings, readings_of
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.common_noise import CommonNoise
from calib.diagnosis.statistics.counts import Counts, grouped
from calib.diagnosis.statistics.few_samples import excess_as_normal
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.diagnosis.statistics.recorded_scatter import wider
from calib.diagnosis.statistics.tones import Peak, find_peaks
from calib.rounding import mean_square_bias

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
        variance = self._recorded_variance.copy()
        noisy = set(self.sensor.noisy)
        if self.growing is not None:
            variance[:, self.growing.pixels] = self.growing.variance_dn2
            noisy -= set(self.growing.pixels.tolist())
        sampling = variance / self.n[:, None] + mean_square_bias(
            np.sqrt(np.maximum(variance - 1.0 / 12.0, 0.0))
        )
        usable = self.baseline.usable.reshape(self.n_blocks, -1)
        weight = np.where(usable, 1.0 / np.sqrt(sampling), 0.0)
        weight[:, sorted(noisy)] = 0.0
        signal = (self.baseline.mean_dn - self.baseline.offset_dn).reshape(self.n_blocks, -1)
        modes = np.concatenate([np.ones_like(signal), signal])
        lines = self.n * self.sensor.n_rows
        per_block = self.common.memory / lines
        strength = np.concatenate(
            [self.common.fixed_dn2 * per_block, self.common.relative * per_block]
        )
        block = np.tile(np.arange(self.n_blocks), 2)
        return mean_space(weight, regressors(self.table, signal.shape), modes, block, strength)

    @property
    def _recorded_variance(self) -> Floats:
        """Of each pixel's samples, (n_blocks, n_pixels): the baseline's, or clearly more."""
        group = np.minimum(self.sensor.group, self.sensor.n_groups - 1)
        some = np.maximum(self.counts.pixels, 1.0)
        variance = self.baseline.variance_dn2
        factors = [
            wider(each, grouped(v, self.sensor) / some, self.sensor, self.counts)[group]
            for each, v in zip(self.sums, variance, strict=True)
        ]
        return np.asarray((variance * np.stack(factors)).reshape(self.n_blocks, -1))

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
        return RareSpace.of(counts, self.n, self.sensor.n_pixels, variance)

    @cached_property
    def rest_places(self) -> dict[str, slice]:
        """Where each kind of statistic besides the means stands in a point's `rest`."""
        sizes = {
            "pooled": self.pooled.std.size,
            "onset": self.n_blocks * ONSET_LINES,
            "rare": self.rare_space.n_sums,
        }
        if self.kept is None:
            sizes |= {"steps": 2 * N_STEPS, "codes": self.code_counts.n_numbers}
        sizes["tones"] = self.n_blocks * len(self.peaks)
        found, start = {}, 0
        for kind, size in sizes.items():
            found[kind] = slice(start, start + size)
            start += size
        return found

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
            self.excess_variance,
            self.code_counts.residual(),
            self._of_peaks([p.squared_amplitude_dn2 for p in self.peaks]),
            self.misfit(self.observed_means, observed=True),
            self.monitor.observed,
        )  # fmt: skip

    @cached_property
    def observed_means(self) -> Floats:
        """Means less those of the baseline, DN, (n_blocks, n_pixels)."""
        means = np.stack([each.mean_dn.ravel() for each in self.sums])
        return np.asarray(means - self.baseline.mean_dn.reshape(means.shape))

    @cached_property
    def excess_variance(self) -> Floats:
        """Each pixel's variance over the expected one in all blocks, less 1, (n_pixels,)."""
        squares = np.zeros(self.sensor.n_pixels)
        for b, each in enumerate(self.sums):
            squares += (each.products.squares / self.baseline.variance_dn2[b]).ravel()
        freedom = (self.n - 1).sum() * (1.0 - 1.0 / self.counts.smallest_tap)
        return excess_as_normal(squares / freedom, float(freedom))

    def point(self, change: Change) -> Point:
        """Return a change in the whitened space, without what the baseline absorbs."""
        means = self.space.project(change.means)
        pool = self.pooled.whitened(change.pooled)
        if self.kept is not None:
            gone = ~self.kept
            onset = np.where(gone[:, None], 0.0, change.onset / self.onset_std)
            rare = self.rare_space.whitened(change.rare, self.kept)
            tones = self._tone_scale.whitened(change.tones, self.kept)
            return Point(means, np.concatenate([pool, onset.ravel(), rare, tones]))
        rest = np.concatenate(
            [
                pool,
                (change.onset / self.onset_std).ravel(),
                self.rare_space.whitened(change.rare),
                steps(change.pixel_variance * np.sqrt((self.n - 1).sum() / 2.0)),
                steps(change.pixel_misfit),
                self.code_counts.whitened(change.codes),
                self._tone_scale.whitened(change.tones),
                self.monitor.whitened(change.monitor),
            ]
        )
        return Point(means, rest)

    def derivative(self, change: Change, about: Change) -> Point:
        """Return the whitened derivative of statistics that move by `change` from `about` on."""
        small = 0.1
        first, after = self.point(about), self.point(about + change * small)
        found = (after - first) * (1.0 / small)
        if self.kept is None:
            where = self.rest_places["steps"]
            counts = np.maximum(np.abs(first.rest[where]), np.abs(after.rest[where]))
            pairs = (
                (change.pixel_variance, about.pixel_variance),
                (change.pixel_misfit, about.pixel_misfit),
            )
            for k, (moved, before) in enumerate(pairs):
                part = slice(where.start + k * N_STEPS, where.start + (k + 1) * N_STEPS)
                mine = counts[k * N_STEPS : (k + 1) * N_STEPS]
                found.rest[part] = held_slopes(found.rest[part], mine, moved, before)
        # Counts and tones are whitened along curves, and changes may be far larger than what is
        # seen of them.
        found.rest[self.rest_places["rare"]] = self.rare_space.derivative(
            change.rare, about.rare, self.kept
        )
        found.rest[self.rest_places["tones"]] = self._tone_scale.derivative(
            change.tones, about.tones, self.kept
        )
        return found

    def without_blocks(self, blocks: NDArray[np.intp]) -> "Evidence":
        """Return the evidence of the other blocks, statistics of all blocks together left out."""
        kept = np.ones(self.n_blocks, bool)
        kept[blocks] = False
        usable = self.baseline.usable & kept[:, None, None]
        baseline = replace(self.baseline, usable=usable)
        return replace(
            self, baseline=baseline, kept=kept, whole=None, known_peaks=self.peaks, of_all=self
        )

    def product(self, one: Point, other: Point) -> float:
        """Return the inner product."""
        return self.space.product(one.means, other.means) + float(one.rest @ other.rest)

    @cached_property
    def signal_dn(self) -> Floats:
        """Mean signal of each block, (n_blocks,)."""
        return np.asarray((self.baseline.mean_dn - self.baseline.offset_dn).mean(axis=(1, 2)))

    @cached_property
    def peaks(self) -> tuple[Peak, ...]:
        """Tones that stand out of the spectra."""
        if self.known_peaks is not None:
            return self.known_peaks
        return find_peaks(self.sums, self.signal_dn)

    def _of_peaks(self, values: Sequence[Sequence[float]]) -> Floats:
        """Return what each peak has in each block, (n_blocks, n_peaks)."""
        return np.array(values).reshape(-1, self.n_blocks).T

    @cached_property
    def _tone_scale(self) -> ToneScale:
        return ToneScale(
            self._of_peaks([p.squared_amplitude_dn2 for p in self.peaks]),
            self._of_peaks([p.std_dn2 for p in self.peaks]),
        )

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
        space = self.space if self.whole is None else self.whole
        return PixelMisfits.of(space, self.table.exposure_us)
