"""Lines with effects in all forms in which they are simulated, against those without.

Means are told by lines without noise, moments of noise and counts by drawn ones, tones by whole
blocks at two phases: each form says what the others do not.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.coded_means import moved_by_codes
from calib.diagnosis.simulation.drawn_lines import Drawn
from calib.diagnosis.simulation.mean_change import mean_change, peak_change, scatter_change
from calib.diagnosis.simulation.sampled_lines import SampledLines
from calib.diagnosis.simulation.short_blocks import as_of_long_blocks
from calib.diagnosis.simulation.tone_lines import ToneLines
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.pooled import ONSET_LINES
from calib.forward.effect import Effect, Stage

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Simulated:
    """What effects do to a few lines of each block.

    Attributes:
        chain: The links about which they act.
        effects: The effects.
        sampled: Lines without noise; none where means are told elsewhere.
        drawn: Lines with noise, of either sign.
        plain: The same without the effects.
        tones: Lines with tones alone.
    """

    chain: FittedChain
    effects: Sequence[Effect]
    sampled: Sequence[SampledLines]
    drawn: Sequence[Drawn]
    plain: Drawn
    tones: ToneLines

    @property
    def coded(self) -> bool:
        """Whether effects act on codes: drawn lines are of whole codes then, tones among them."""
        return act_on_codes(self.effects)

    def means(self) -> tuple[Floats, Floats]:
        """Return changes of means, DN, (n_blocks, n_pixels), and first lines', (n_blocks, 3)."""
        if not self.sampled:
            blocks = len(self.chain.table.blocks)
            means = np.zeros((blocks, self.chain.sensor.n_pixels))
            return means, np.zeros((blocks, ONSET_LINES))
        means, onset = mean_change(self.sampled)
        if self.coded:
            means = means + moved_by_codes(self.chain, self.effects, means)
        return means, onset

    def ratio(self) -> Floats:
        """Return changes of each pixel's variance over its expected one, (n_blocks, n_pixels)."""
        ratio = _mean([d.ratio for d in self.drawn]) - self.plain.ratio
        return ratio if self.coded else ratio + self.tones.pixel_ratio(self._variance)

    def scatter(self, sensor: Sensor, counts: Counts) -> tuple[Floats, Floats]:
        """Return changes of pooled statistics, (n_blocks, n_pooled), and of rates of rare events.

        Args:
            sensor: The sensor, without pixels that effects make noisy.
            counts: Its counts.
        """
        variance, recorded = self._variance, self.chain.table.n_lines
        moved = _mean([each.pooled(variance, sensor, counts) for each in self.drawn])
        moved = moved - self.plain.pooled(variance, sensor, counts)
        moved = as_of_long_blocks(moved, self.plain.drawn, recorded, sensor, counts)
        rare = _mean([d.rare(sensor) for d in self.drawn]) - self.plain.rare(sensor)
        if self._without_events:
            scatter, counted = scatter_change(self._without_events, variance, sensor, counts)
            moved, rare = moved + scatter, rare + counted
        of_tones = None if self.coded else self.tones.scatter(variance, sensor, counts)
        if of_tones is not None:
            moved, rare = moved + of_tones[0], rare + of_tones[1]
        return moved, rare

    def at_peaks(self, peaks: Sequence[Peak]) -> Floats:
        """Return the change of squared amplitudes at the peaks, DN^2, (n_blocks, n_peaks)."""
        found = self.tones.at_peaks(peaks, len(self.chain.table.blocks))
        if self._without_events:
            found = found + peak_change(self._without_events, self._variance, peaks)
        return found

    @property
    def _variance(self) -> Floats:
        return self.chain.baseline.variance_dn2

    @property
    def _without_events(self) -> Sequence[SampledLines]:
        """Lines without noise where no effect has events, which would be counted in them again."""
        return () if any(map(self.chain.has_events, self.effects)) else self.sampled


def act_on_codes(effects: Sequence[Effect]) -> bool:
    """Return whether one of the effects acts on codes."""
    return any(effect.stage >= Stage.CODES for effect in effects)


def _mean(values: Sequence[Floats]) -> Floats:
    return values[0] if len(values) == 1 else np.mean(values, axis=0)
