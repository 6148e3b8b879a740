"""What effects change in all statistics of a recording, against the baseline."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline import Baseline
from calib.diagnosis.chain_run import FittedChain, spread_lines
from calib.diagnosis.code_counts import fine_blocks
from calib.diagnosis.conditions_table import ConditionsTable
from calib.diagnosis.noisy import NOISY_SIGMA, few
from calib.diagnosis.pooled import ONSET_LINES, Counts, pooled
from calib.diagnosis.sensor import Sensor
from calib.diagnosis.short_blocks import as_of_long_blocks
from calib.diagnosis.statistics.gather import CUT_SIGMA
from calib.diagnosis.statistics.rare import rare_counts, rare_trials, repeated_lines
from calib.diagnosis.tones import Peak
from calib.diagnosis.with_values import with_values
from calib.forward.departure import Departure
from calib.forward.effect import Effect, Stage
from calib.forward.left import Left
from calib.kernels.residual_products import ResidualProducts, residual_products

Floats = NDArray[np.float64]

SAMPLES = 120_000
"""So many are drawn of the whole recording."""
FEWEST_LINES, MOST_LINES = 8, 48
FEW_EVENTS = 10.0
"""So many in a block tell their rate as well as other blocks' do."""


@dataclass(frozen=True)
class Change:
    """A change of the statistics, or the statistics themselves.

    Attributes:
        means: Of each block's pixels, DN, (n_blocks, n_pixels).
        onset: Of the first lines' means against the block's later ones, DN, (n_blocks, 3).
        pooled: Of each block's pooled statistics, (n_blocks, n_pooled).
        rare: Of what is counted, by trial, (n_blocks, n_rare).
        pixel_variance: Of each pixel's variance over the expected one, all blocks, (n_pixels,).
        pixel_misfit: By how many standard deviations each pixel's means miss, (n_pixels,).
        pixel_growth: Likewise, how they grow with the exposure beyond the baseline.
        tones: Of squared amplitudes at the peaks of the spectrum, DN^2, (n_blocks, n_tones).
        codes: Of the share of samples by code, (1 or 2 draws, n_codes); where only effects before
            the conversion change anything, means and variances say it all, and this is 0.
    """

    means: Floats
    onset: Floats
    pooled: Floats
    rare: Floats
    pixel_variance: Floats
    codes: Floats
    tones: Floats
    pixel_misfit: Floats
    pixel_growth: Floats

    def __sub__(self, other: "Change") -> "Change":
        """Return the difference."""
        return Change(*(a - b for a, b in zip(self.parts(), other.parts(), strict=True)))

    def __add__(self, other: "Change") -> "Change":
        """Return the sum."""
        return Change(*(a + b for a, b in zip(self.parts(), other.parts(), strict=True)))

    def __mul__(self, factor: float) -> "Change":
        """Return it scaled."""
        return Change(*(a * factor for a in self.parts()))

    def parts(self) -> tuple[Floats, ...]:
        """Return its arrays."""
        return (
            self.means, self.onset, self.pooled, self.rare, self.pixel_variance, self.codes,
            self.tones, self.pixel_misfit, self.pixel_growth,
        )  # fmt: skip


@dataclass(frozen=True)
class Responder:
    """Simulates changes on few lines, from the same random numbers with and without effects.

    Attributes:
        chain: The baseline.
        counts: Of its sensor.
        peaks: Of the spectrum.
        plain: What is compared with, where it is not the same chain without effects.
    """

    chain: FittedChain
    counts: Counts
    peaks: tuple[Peak, ...] = ()
    plain: "Responder | None" = None

    def about(self, baseline: Baseline) -> "Responder":
        """Return what adds effects to the links of `baseline`, and compares as this one does."""
        if baseline is self.chain.baseline:
            return self
        return replace(self, chain=replace(self.chain, baseline=baseline), plain=self.plain or self)

    @cached_property
    def n_lines(self) -> int:
        """Lines that are drawn of each block."""
        per_line = self.chain.sensor.n_pixels * len(self.chain.table.blocks)
        wanted = int(np.clip(SAMPLES // per_line, FEWEST_LINES, MOST_LINES))
        return max(2, min(wanted, int(self.chain.table.n_lines.min())))

    def change(self, effects: Sequence[Effect], draw: int = 0) -> Change:
        """Return what `effects` change."""
        lefts = self.chain.left_before(effects)
        coded = any(e.stage >= Stage.CODES for e in effects)
        blocks = range(len(lefts))
        means, onset = zip(*(self._means(b, effects, lefts[b], draw) for b in blocks), strict=True)
        drawn = [self._drawn(b, effects, lefts[b], draw, coded=coded) for b in blocks]
        other = self.plain or self
        plain = [other.plain_drawn(b, draw, coded=coded) for b in blocks]
        weight = self.chain.table.n_lines - 1
        ratio = np.average(
            [d.ratio - p.ratio for d, p in zip(drawn, plain, strict=True)], 0, weight
        )
        z = ratio * np.sqrt(weight.sum() / 2.0)
        fine = fine_blocks(self.chain.baseline)
        counts, sensor = self._cleaned(few(np.flatnonzero(z > NOISY_SIGMA), len(z)))
        return Change(
            np.stack(means),
            np.stack(onset),
            as_of_long_blocks(
                np.stack([
                    self._pooled(b, drawn[b].products, sensor, counts)
                    - self._pooled(b, plain[b].products, sensor, counts)
                    for b in blocks
                ]),
                self.n_lines, self.chain.table.n_lines, sensor,
            ),
            _by_conditions(
                np.stack([d.rare - p.rare for d, p in zip(drawn, plain, strict=True)]),
                rare_trials(self.n_lines, self.chain.sensor.n_pixels),
                self.chain.table,
            ),
            ratio,
            _codes(drawn, plain, (weight + 1) * fine, coded=coded),
            self._tones(effects, lefts),
            np.zeros(len(ratio)),
            np.zeros(len(ratio)),
        )  # fmt: skip

    def _tones(self, effects: Sequence[Effect], lefts: Sequence[Left | None]) -> Floats:
        """Return squared amplitudes at the peaks that effects of the spectrum give, DN^2."""
        tonal = [e for e in effects if isinstance(e, Departure) and e.shows_in == "spectrum"]
        found = np.zeros((len(lefts), len(self.peaks)))
        if not tonal or not self.peaks:
            return found
        lines = np.arange(self.n_lines, dtype=np.float64)
        for b, left in enumerate(lefts):
            at = replace(self.chain.table.at(b, lines), before=left)
            change = self.chain.noise_free(at, tonal, b, 0)
            change = change - self.chain.baseline.mean_dn[b].ravel()
            found[b] = [peak.squared_amplitude(change) for peak in self.peaks]
        return found

    def _cleaned(self, noisy: NDArray[np.intp]) -> tuple[Counts, Sensor]:
        if len(noisy) == 0:
            return self.counts, self.chain.sensor
        sensor = Sensor(self.chain.sensor.camera, tuple(int(p) for p in noisy))
        return Counts.of(sensor), sensor

    def _pooled(self, b: int, products: ResidualProducts, sensor: Sensor, counts: Counts) -> Floats:
        variance = self.chain.baseline.variance_dn2[b]
        return pooled(products, len(products.line_means), variance, sensor, counts).vector()

    def _means(
        self, b: int, effects: Sequence[Effect], left: Left | None, draw: int
    ) -> tuple[Floats, Floats]:
        """Return the change of a block's means, (n_pixels,), and of its first lines, (3,)."""
        table, n = self.chain.table, int(self.chain.table.n_lines[b])
        effects = tuple(_undivided(effect) for effect in effects)
        left = _as_it_is(left, effects)
        stretches, weights = spread_lines(n)
        if not any(_remembers(e) for e in effects):
            stretches = (np.concatenate(stretches),)
        parts = []
        for lines in stretches:
            before = left
            if len(stretches) > 1 and lines[0] > 0:
                before = self.chain.left_after(b, int(lines[0]), effects, left)
                before = _as_it_is(before, effects)
            at = replace(table.at(b, lines), before=before)
            parts.append(self.chain.noise_free(at, effects, b, draw))
        plain = self.chain.baseline.mean_dn[b].ravel()
        change = np.concatenate(parts) - plain
        mean = weights @ change
        onset = np.zeros(ONSET_LINES)
        later = change[len(change) // 2 :].mean()
        first = change[:ONSET_LINES].mean(axis=1)
        onset[: len(first)] = first - later
        return mean, onset

    def _drawn(
        self, b: int, effects: Sequence[Effect], left: Left | None, draw: int, *, coded: bool
    ) -> "_Drawn":
        n, sensor = self.n_lines, self.chain.sensor
        variance = self.chain.baseline.variance_dn2[b]
        at = replace(self.chain.table.at(b, np.arange(n, dtype=np.float64)), before=left)
        lines = self.chain.drawn(at, effects, b, draw)
        n_codes = sensor.camera.full_scale_dn + 1
        if coded:
            lines = np.clip(np.floor(lines + 0.5), 0, n_codes - 1)
        repeated = repeated_lines(lines) if coded else np.zeros(n, bool)
        lines = lines[~repeated]
        mean, sigma = lines.mean(axis=0), np.sqrt(variance)
        products = residual_products(
            lines, mean, CUT_SIGMA * sigma + 1.0, sensor.tap, sensor.n_taps, sensor.partner
        )
        rare = rare_counts(lines, mean, sigma, products.outliers, int(repeated.sum()))
        codes = lines.ravel().astype(np.int64) if coded else np.zeros(0, np.int64)
        return _Drawn(
            products,
            rare / rare_trials(n, sensor.n_pixels),
            (products.squares / (variance * max(len(lines) - 1, 1))).ravel(),
            np.bincount(codes, minlength=n_codes) / max(len(codes), 1),
        )

    def plain_drawn(self, b: int, draw: int, *, coded: bool) -> "_Drawn":
        """Return the lines of block `b` without effects, drawn once."""
        key = (b, draw, coded)
        if key not in self._plain:
            self._plain[key] = self._drawn(b, (), None, draw, coded=coded)
        return self._plain[key]

    @cached_property
    def _plain(self) -> dict[tuple[int, int, bool], "_Drawn"]:
        return {}


@dataclass(frozen=True)
class _Drawn:
    """A few lines of a block: products, rates, each pixel's variance ratio, shares of codes."""

    products: ResidualProducts
    rare: Floats
    ratio: Floats
    codes: Floats


def _codes(
    drawn: Sequence["_Drawn"], plain: Sequence["_Drawn"], weight: Floats, *, coded: bool
) -> Floats:
    """Return the change of code shares, (1, n_codes), or nothing in two draws."""
    if coded and weight.any():
        changes = [d.codes - p.codes for d, p in zip(drawn, plain, strict=True)]
        return np.asarray(np.average(changes, 0, weight))[None]
    return np.zeros((2, len(drawn[0].codes)))


def _by_conditions(rates: Floats, trials: Floats, table: ConditionsTable) -> Floats:
    """Return rates, (n_blocks, n), the smoother the fewer events they are told by."""
    light = table.dose / max(float(table.dose.max()), 1e-300)
    exposure = table.exposure_us / float(table.exposure_us.max())
    design = np.stack([np.ones_like(light), exposure, light, table.dark.astype(float)], axis=1)
    smooth = np.asarray(design @ np.linalg.lstsq(design, rates, rcond=None)[0])
    events = np.abs(rates) * trials
    return np.asarray((events * rates + FEW_EVENTS * smooth) / (events + FEW_EVENTS))


def _undivided(effect: Effect) -> Effect:
    """Return the effect with charge parted exactly by its share: what it does on average."""
    if not isinstance(effect, Departure) or not hasattr(effect, "partition_noise"):
        return effect
    return with_values(effect, {"partition_noise": 0.0})


def _as_it_is(left: Left | None, effects: Sequence[Effect]) -> Left | None:
    """Return what was left on average as if drawn, where no effect takes it for whole electrons."""
    if left is None or not all(hasattr(e, "partition_noise") for e in effects if _remembers(e)):
        return left
    return replace(left, drawn=True)


def _remembers(effect: Effect) -> bool:
    return hasattr(effect, "carry")
