"""A recording's statistics against the baseline, whitened: what is looked for signatures in."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline import Baseline
from calib.diagnosis.change import Change
from calib.diagnosis.code_counts import CodeCounts
from calib.diagnosis.common_noise import CommonNoise
from calib.diagnosis.conditions_table import ConditionsTable
from calib.diagnosis.few_samples import excess_as_normal
from calib.diagnosis.mean_space import MeanSpace, mean_space
from calib.diagnosis.monitor import MonitorReadings, readings_of
from calib.diagnosis.nuisance import regressors, scene_blocks
from calib.diagnosis.point import Point
from calib.diagnosis.pooled import (
    KINDS,
    ONSET_LINES,
    Counts,
    Pooled,
    expected,
    grouped,
    places,
    pooled,
)
from calib.diagnosis.sensor import Sensor
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.rare import rare_trials
from calib.diagnosis.tones import Peak, find_peaks
from calib.rounding import mean_square_bias

Floats = NDArray[np.float64]

TONE_ERROR = 0.08
"""Of squared amplitudes: a tone lies between two frequencies of the spectrum."""
STEPS_SIGMA = (5.0, 9.0, 16.0, 40.0)
"""Pixels beyond these are counted, of their variances and of their means' misfit."""
MAD_OF_NORMAL = 0.6745
"""Median absolute deviation of a standard normal variable."""
CHANCE_COUNT = 0.05
"""Variance of a count of pixels that should be 0."""
CHANCE_RARE = np.array([0.03, 0.03, 0.03, 0.01])
"""Likewise of what is counted in a block."""


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

    @cached_property
    def places(self) -> dict[str, slice]:
        """Where each kind of pooled statistic stands in a block's vector."""
        return places(self.sensor)

    @property
    def n_blocks(self) -> int:
        """How many blocks there are."""
        return len(self.sums)

    @cached_property
    def n(self) -> Floats:
        """Lines of each block."""
        return np.array([each.n_lines for each in self.sums], np.float64)

    @cached_property
    def space(self) -> MeanSpace:
        """The space of the means."""
        variance = self.baseline.variance_dn2.reshape(self.n_blocks, -1)
        sampling = variance / self.n[:, None] + mean_square_bias(
            np.sqrt(np.maximum(variance - 1.0 / 12.0, 0.0))
        )
        usable = self.baseline.usable.reshape(self.n_blocks, -1)
        weight = np.where(usable, 1.0 / np.sqrt(sampling), 0.0)
        weight[:, list(self.sensor.noisy)] = 0.0
        signal = (self.baseline.mean_dn - self.baseline.offset_dn).reshape(self.n_blocks, -1)
        modes = np.concatenate([np.ones_like(signal), signal])
        lines = self.n * self.sensor.n_rows
        per_block = self.common.memory / lines
        strength = np.concatenate(
            [self.common.fixed_dn2 * per_block, self.common.relative * per_block]
        )
        block = np.tile(np.arange(self.n_blocks), 2)
        return mean_space(weight, regressors(self.table, signal.shape), modes, block, strength)

    @cached_property
    def expected(self) -> tuple[tuple[Pooled, Pooled], ...]:
        """Each block's pooled statistics as the baseline expects them, and their deviations."""
        pairs = []
        for b in range(self.n_blocks):
            gain = self.baseline.gain_dn_per_e[self.sensor.tap]
            signal = np.maximum(self.baseline.mean_dn[b] - self.baseline.offset_dn, 0.0)
            variance = self.baseline.variance_dn2[b]
            pair = expected(variance, gain**3 * signal, int(self.n[b]), self.sensor, self.counts)
            shared = self.common.fixed_dn2 + self.common.relative * float(signal.mean()) ** 2
            for kind in ("common", "common_taps", "common_1", "common_2"):
                white = np.maximum(pair[0].of["common"].mean(), 1e-300)
                pair[1].of[kind] *= 1.0 + shared / white
            pairs.append(pair)
        return tuple(pairs)

    @cached_property
    def pooled_std(self) -> Floats:
        """Standard deviations of the pooled statistics, (n_blocks, n_pooled); inf: not used."""
        std = np.stack([std.vector() for _, std in self.expected])
        # The noise of pixels side by side in bright and dark parts has no common level.
        std[scene_blocks(self.table)] = np.inf
        if self.kept is not None:
            std[~self.kept] = np.inf
        return std

    @cached_property
    def code_counts(self) -> CodeCounts:
        """What the histogram of codes is compared with."""
        return CodeCounts.of(self.sums, self.baseline)

    @cached_property
    def monitor(self) -> MonitorReadings:
        """What the monitor read."""
        return readings_of(self.table)

    def observed(self) -> Change:
        """Return the differences of what was recorded from what the baseline expects."""
        vectors, onset, rare = [], np.zeros((self.n_blocks, ONSET_LINES)), []
        squares = np.zeros(self.sensor.n_pixels)
        for b, each in enumerate(self.sums):
            variance = self.baseline.variance_dn2[b]
            values = pooled(each.products, each.n_lines, variance, self.sensor, self.counts)
            vectors.append(values.vector() - self.expected[b][0].vector())
            line = each.products.line_means.mean(axis=(1, 2))
            k = min(ONSET_LINES, len(line) // 2)
            onset[b, :k] = line[:k] - line[len(line) // 2 :].mean()
            rare.append(each.rare / rare_trials(each.n_lines, self.sensor.n_pixels))
            squares += (each.products.squares / variance).ravel()
        means = np.stack([each.mean_dn.ravel() for each in self.sums])
        means = means - self.baseline.mean_dn.reshape(means.shape)
        freedom = (self.n - 1).sum() * (1.0 - 1.0 / self.counts.smallest_tap)
        misfit, growth = self.misfit(means, observed=True), self.growth(means)
        return Change(
            means, onset, np.stack(vectors), np.stack(rare),
            excess_as_normal(squares / freedom, float(freedom)),
            self.code_counts.residual(),
            self._of_peaks([p.squared_amplitude_dn2 for p in self.peaks]),
            misfit,
            growth,
            self.monitor.observed,
        )  # fmt: skip

    def point(self, change: Change) -> Point:
        """Return a change in the whitened space, without what the baseline absorbs."""
        means = self.space.project(change.means)
        pool = np.where(
            np.isfinite(self.pooled_std) & (self.pooled_std > 0),
            change.pooled / np.where(self.pooled_std > 0, self.pooled_std, 1.0), 0.0,
        ).ravel()  # fmt: skip
        for direction in self._noise_directions:
            pool = pool - direction * float(direction @ pool)
        if self.kept is not None:
            gone = ~self.kept
            onset = np.where(gone[:, None], 0.0, change.onset / self._onset_std)
            rare = np.where(gone[:, None], 0.0, change.rare / self._rare_std)
            tones = np.where(gone[:, None], 0.0, change.tones / self._tone_std)
            return Point(means, np.concatenate([pool, onset.ravel(), rare.ravel(), tones.ravel()]))
        rest = np.concatenate(
            [
                pool,
                (change.onset / self._onset_std).ravel(),
                (change.rare / self._rare_std).ravel(),
                self._steps(change.pixel_variance * np.sqrt((self.n - 1).sum() / 2.0)),
                self._steps(change.pixel_misfit),
                self._steps(change.pixel_growth),
                self.code_counts.whitened(change.codes),
                (change.tones / self._tone_std).ravel(),
                self.monitor.whitened(change.monitor),
            ]
        )
        return Point(means, rest)

    def derivative(self, change: Change, about: Change) -> Point:
        """Return the whitened derivative of statistics that move by `change` from `about` on."""
        small = 0.1
        return (self.point(about + change * small) - self.point(about)) * (1.0 / small)

    def without_blocks(self, blocks: NDArray[np.intp]) -> "Evidence":
        """Return the evidence of the other blocks, statistics of all blocks together left out."""
        kept = np.ones(self.n_blocks, bool)
        kept[blocks] = False
        usable = self.baseline.usable & kept[:, None, None]
        baseline = replace(self.baseline, usable=usable)
        return replace(self, baseline=baseline, kept=kept, whole=None, known_peaks=self.peaks)

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

    @property
    def _tone_std(self) -> Floats:
        floor = self._of_peaks([p.std_dn2 for p in self.peaks])
        values = self._of_peaks([p.squared_amplitude_dn2 for p in self.peaks])
        smooth = np.maximum(values, 0.0).mean(axis=0)
        return np.asarray(np.sqrt(floor**2 + 2.0 * floor * smooth + (TONE_ERROR * smooth) ** 2))

    @cached_property
    def _onset_std(self) -> Floats:
        std = np.full((self.n_blocks, ONSET_LINES), np.inf)
        for b in range(1, self.n_blocks):
            signal = float((self.baseline.mean_dn[b] - self.baseline.offset_dn).mean())
            white = float(self.baseline.variance_dn2[b].mean()) / self.sensor.n_pixels
            shared = self.common.fixed_dn2 + self.common.relative * signal**2
            if self.n[b] >= 2 * ONSET_LINES:
                std[b] = np.sqrt((white + shared / self.sensor.n_rows) * (1.0 + 2.0 / self.n[b]))
        return std

    @cached_property
    def _noise_directions(self) -> tuple[Floats, ...]:
        """Whitened changes of the pooled variances with each tap's gain and read noise."""
        directions: list[Floats] = []
        start = KINDS.index("variance")
        assert start == 0  # noqa: S101 - variances stand first in the vector
        groups = np.maximum(self.counts.pixels, 1.0)
        for tap in range(self.sensor.n_taps):
            of_tap = (self.sensor.tap == tap).astype(np.float64)
            for b_signal in (True, False):
                change = np.zeros_like(self.pooled_std)
                for b in range(self.n_blocks):
                    each = of_tap
                    if b_signal:
                        each = of_tap * (self.baseline.mean_dn[b] - self.baseline.offset_dn)
                    change[b, : self.sensor.n_groups] = grouped(each, self.sensor) / groups
                fine = np.isfinite(self.pooled_std) & (self.pooled_std > 0)
                white = np.where(fine, change / np.where(fine, self.pooled_std, 1.0), 0.0).ravel()
                length = float(white @ white)
                for direction in (*directions, *directions):
                    white = white - direction * float(direction @ white)
                left = float(white @ white)
                if left > 1e-9 * max(length, 1e-300):
                    directions.append(white / np.sqrt(left))
        return tuple(directions)

    @cached_property
    def _rare_std(self) -> Floats:
        trials = np.stack([rare_trials(n, self.sensor.n_pixels) for n in self.n])
        seen = np.stack([each.rare for each in self.sums])
        level = seen.sum(axis=0) / trials.sum(axis=0) * trials
        return np.asarray(np.sqrt(CHANCE_RARE + level) / trials)

    def _steps(self, z: Floats) -> Floats:
        """Return how many pixels stand out of all others: what all do is in the means."""
        middle = np.median(z)
        z = (z - middle) / max(float(np.median(np.abs(z - middle))) / MAD_OF_NORMAL, 1.0)
        counts = np.array([(z > step).sum() for step in STEPS_SIGMA] + [(z < -5.0).sum()], float)
        return np.asarray(counts / np.sqrt(CHANCE_COUNT + 0.1 * counts))

    def growth(self, means: Floats) -> Floats:
        """Return by how many standard deviations each pixel's means grow with the exposure."""
        space = self.space if self.whole is None else self.whole
        exposure = np.broadcast_to(self.table.exposure_us[:, None], means.shape)
        direction, white = space.project(exposure), space.project(means)
        length2 = np.einsum("bp,bp->p", direction, direction)
        along = np.einsum("bp,bp->p", direction, white)
        told = length2 > 1e-6 * np.maximum((space.weight**2 * exposure**2).sum(axis=0), 1e-300)
        return np.where(told, along / np.sqrt(np.where(told, length2, 1.0)), 0.0)

    def misfit(self, means: Floats, *, observed: bool) -> Floats:
        """Return by how many standard deviations each pixel's means, DN, miss the baseline."""
        space = self.space if self.whole is None else self.whole
        white = space.project(means)
        used = np.maximum((space.weight > 0).sum(axis=0) - len(space.basis), 1)
        square = np.einsum("bp,bp->p", white, white)
        if not observed:
            return np.asarray(square / np.sqrt(2.0 * used))
        third = (square / used) ** (1 / 3)
        return np.asarray((third - (1.0 - 2.0 / (9.0 * used))) / np.sqrt(2.0 / (9.0 * used)))
