"""What effects change in all statistics of a recording, against the baseline."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.code_counts import fine_blocks
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.coded_means import moved_by_codes
from calib.diagnosis.simulation.drawn_lines import Drawn, drawn_of
from calib.diagnosis.simulation.known_changes import KnownChanges
from calib.diagnosis.simulation.mean_change import mean_change, peak_change, scatter_change
from calib.diagnosis.simulation.opposite_tone import opposite_tone
from calib.diagnosis.simulation.sampled_lines import is_tone, sampled_lines
from calib.diagnosis.simulation.short_blocks import as_of_long_blocks
from calib.diagnosis.simulation.stack import Stack
from calib.diagnosis.simulation.tone_lines import ToneLines
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.noisy import NOISY_SIGMA, few
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.diagnosis.statistics.rare import rare_trials
from calib.diagnosis.statistics.tones import Peak
from calib.forward.departure import Departure
from calib.forward.effect import Effect, Stage
from calib.forward.left import Left

Floats = NDArray[np.float64]

SAMPLES = 120_000
"""So many are drawn of the whole recording."""
FEWEST_LINES, MOST_LINES = 8, 16
FEW_EVENTS = 10.0
"""So many in a block tell their rate as well as other blocks' do."""


@dataclass(frozen=True)
class Responder:
    """Simulates changes on few lines, from the same noise with and without effects.

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
        return replace(self, chain=self.chain.about(baseline), plain=self.plain or self)

    @cached_property
    def n_lines(self) -> int:
        """Lines that are drawn of each block."""
        per_line = self.chain.sensor.n_pixels * len(self.chain.table.blocks)
        wanted = int(np.clip(SAMPLES // per_line, FEWEST_LINES, MOST_LINES))
        return max(2, min(wanted, int(self.chain.table.n_lines.min())))

    def change(
        self, effects: Sequence[Effect], draw: int = 0, *, drawn_alone: bool = False
    ) -> Change:
        """Return what `effects` change.

        Args:
            effects: The effects.
            draw: Number of the noise.
            drawn_alone: Where means are told elsewhere, only what drawn lines show; no means.
        """
        lefts = self.chain.left_before(effects)
        coded = any(e.stage >= Stage.CODES for e in effects)
        others = [e for e in effects if e.stage < Stage.CODES]
        sampled = [] if drawn_alone else sampled_lines(self.chain, others, lefts, draw)
        means, onset = mean_change(sampled) if sampled else self._no_change_of_means()
        # An effect's own noise has chance products with that of the baseline, of either sign.
        tones = ToneLines.of(self.chain, effects)
        in_lines = effects if coded else [e for e in effects if not is_tone(e)]
        signed = {1.0: in_lines}
        if any(map(self.chain.has_noise, in_lines)) or any(map(is_tone, in_lines)):
            signed[-1.0] = [opposite_tone(effect) for effect in in_lines]
        drawn = [self._drawn(e, lefts, draw, coded=coded, sign=sign) for sign, e in signed.items()]
        plain = (self.plain or self).plain_drawn(draw, coded=coded)
        if coded and sampled:
            means = means + moved_by_codes(self.chain, effects, means)
        table = self.chain.table
        weight = table.n_lines - 1
        variance = self.chain.baseline.variance_dn2
        ratio = _mean([d.ratio for d in drawn]) - plain.ratio
        if not coded:
            ratio = ratio + tones.pixel_ratio(variance)
        ratio = np.average(ratio, 0, weight)
        z = ratio * np.sqrt(weight.sum() / 2.0)
        counts, sensor = self._cleaned(few(np.flatnonzero(z > NOISY_SIGMA), len(z)))
        moved = _mean([each.pooled(variance, sensor, counts) for each in drawn])
        moved = moved - plain.pooled(variance, sensor, counts)
        moved = as_of_long_blocks(moved, self.n_lines, table.n_lines, sensor, counts)
        rare = _mean([d.rare(sensor) for d in drawn]) - plain.rare(sensor)
        at_peaks = tones.at_peaks(self.peaks, len(table.blocks))
        if sampled and not any(map(self.chain.has_events, effects)):
            scatter, counted = scatter_change(sampled, variance, sensor, counts)
            moved, rare = moved + scatter, rare + counted
            at_peaks = at_peaks + peak_change(sampled, variance, self.peaks)
        of_tones = None if coded else tones.scatter(variance, sensor, counts)
        if of_tones is not None:
            moved, rare = moved + of_tones[0], rare + of_tones[1]
        trials = rare_trials(self.n_lines, self.chain.sensor.n_pixels)
        return Change(
            means,
            onset,
            moved,
            self._by_conditions(rare, trials),
            ratio,
            _codes(
                [d.codes for d in drawn],
                plain.codes,
                (weight + 1) * self._fine,
                coded=any(map(_is_in_histogram, effects)),
            ),
            at_peaks,
            np.zeros(len(ratio)),
        )

    def _no_change_of_means(self) -> tuple[Floats, Floats]:
        blocks = len(self.chain.table.blocks)
        return np.zeros((blocks, self.chain.sensor.n_pixels)), np.zeros((blocks, ONSET_LINES))

    def _cleaned(self, noisy: NDArray[np.intp]) -> tuple[Counts, Sensor]:
        if len(noisy) == 0:
            return self.counts, self.chain.sensor
        sensor = Sensor(self.chain.sensor.camera, tuple(int(p) for p in noisy))
        return Counts.of(sensor), sensor

    def _drawn(
        self,
        effects: Sequence[Effect],
        lefts: Sequence[Left | None],
        draw: int,
        *,
        coded: bool,
        sign: float = 1.0,
    ) -> Drawn:
        """Return lines from the middle of each block, where a step before it has died away."""
        chain, n = self.chain, self.n_lines
        first = [(int(lines) - n) // 2 for lines in chain.table.n_lines]
        stack = self._middle
        if any(left is not None for left in lefts):
            found = enumerate(zip(first, lefts, strict=True))
            stack = stack.before([chain.left_after(b, k, effects, x) for b, (k, x) in found])
        lines = chain.drawn(stack, effects, draw, coded=coded, sign=sign)
        return drawn_of(lines.reshape(-1, n, *lines.shape[1:]), chain, coded=coded)

    @cached_property
    def _middle(self) -> Stack:
        n, table = self.n_lines, self.chain.table
        first = [(int(lines) - n) // 2 for lines in table.n_lines]
        return Stack.of(table, [(b, k + np.arange(float(n))) for b, k in enumerate(first)], "drawn")

    def plain_drawn(self, draw: int, *, coded: bool) -> Drawn:
        """Return lines without effects, drawn once."""
        if (draw, coded) not in self._plain:
            nothing = (None,) * len(self.chain.table.blocks)
            self._plain[draw, coded] = self._drawn((), nothing, draw, coded=coded)
        return self._plain[draw, coded]

    @cached_property
    def moved_dn(self) -> Floats:
        """What the links' means have moved by from what is compared with, (n_blocks, n_pixels)."""
        base = self.chain.baseline
        moved = base.offset_dn + base.slope * base.dose - base.mean_dn
        return (
            moved.reshape(len(moved), -1) if self.plain else np.zeros((len(moved), moved[0].size))
        )

    @cached_property
    def known(self) -> KnownChanges:
        """What was simulated about this baseline, and about those that follow from it."""
        return KnownChanges() if self.plain is None else self.plain.known

    @cached_property
    def links_key(self) -> Hashable:
        """What the links follow from, and whether they are compared with others."""
        base = self.chain.baseline
        links = (base.offset_dn, base.slope, base.gain_dn_per_e, base.read_variance_dn2)
        return (self.plain is None, *(each.tobytes() for each in links))

    @cached_property
    def of_events(self) -> dict[Departure, Change]:
        """What effects made of events change where these are dense, as far as it is known."""
        return {}

    @cached_property
    def _fine(self) -> NDArray[np.bool_]:
        return fine_blocks(self.chain.baseline)

    def _by_conditions(self, rates: Floats, trials: Floats) -> Floats:
        """Return rates, (n_blocks, n), the smoother the fewer events they are told by."""
        if not rates.any():
            return rates
        smooth = self._smoothing @ rates
        events = np.abs(rates) * trials
        return np.asarray((events * rates + FEW_EVENTS * smooth) / (events + FEW_EVENTS))

    @cached_property
    def _smoothing(self) -> Floats:
        """What fits blocks' values by exposure and light, (n_blocks, n_blocks)."""
        table = self.chain.table
        light = table.dose / max(float(table.dose.max()), 1e-300)
        exposure = table.exposure_us / float(table.exposure_us.max())
        of_all = (np.ones_like(light), exposure, light, table.dark.astype(float))
        design = np.stack(of_all, axis=1)
        return np.asarray(design @ np.linalg.pinv(design))

    @cached_property
    def _plain(self) -> dict[tuple[int, bool], Drawn]:
        return {}


def _mean(values: Sequence[Floats]) -> Floats:
    return values[0] if len(values) == 1 else np.mean(values, axis=0)


def _is_in_histogram(effect: Effect) -> bool:
    """Return whether an effect changes how often codes are seen about a pixel's own mean."""
    if effect.stage < Stage.CODES or not isinstance(effect, Departure):
        return False
    return effect.shows_in == "histogram"


def _codes(drawn: Sequence[Floats], plain: Floats, weight: Floats, *, coded: bool) -> Floats:
    """Return the change of code shares, (1, n_codes), or nothing in two draws, (2, 1)."""
    if coded and weight.any():
        return np.asarray(np.average(_mean(drawn) - plain, 0, weight))[None]
    return np.zeros((2, 1))
