"""What effects change in all statistics of a recording, against the baseline."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.drawing import Drawing
from calib.diagnosis.simulation.fault_surroundings import Surroundings
from calib.diagnosis.simulation.latest import Latest
from calib.diagnosis.simulation.sampled_lines import sampled_lines
from calib.diagnosis.simulation.simulated import Simulated, act_on_codes
from calib.diagnosis.simulation.smoothed_rates import smoothed_rates
from calib.diagnosis.simulation.tone_lines import ToneLines
from calib.diagnosis.statistics.change import Change
from calib.diagnosis.statistics.counts import Counts
from calib.diagnosis.statistics.noisy import NOISY_SIGMA, few
from calib.diagnosis.statistics.peak import Peak
from calib.diagnosis.statistics.rare import rare_trials
from calib.forward.departure import Departure
from calib.forward.effect import Effect, Stage

Floats = NDArray[np.float64]

MOST_BYTES = 1 << 27
"""Of changes that are kept."""
KEPT = 2
"""Surroundings that are kept at a time."""


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
    def drawing(self) -> Drawing:
        """What draws lines of each block."""
        return Drawing(self.chain)

    def change(
        self, effects: Sequence[Effect], draw: int = 0, *, drawn_alone: bool = False
    ) -> Change:
        """Return what `effects` change.

        Args:
            effects: The effects.
            draw: Number of the noise.
            drawn_alone: Where means are told elsewhere, only what drawn lines show; no means.
        """
        lines = self._simulated(effects, draw, drawn_alone=drawn_alone)
        table, ratio = self.chain.table, lines.ratio()
        weight = table.n_lines - 1
        ratio = np.average(ratio, 0, weight)
        z = ratio * np.sqrt(weight.sum() / 2.0)
        counts, sensor = self._cleaned(few(np.flatnonzero(z > NOISY_SIGMA), len(z)))
        moved, rare = lines.scatter(sensor, counts)
        trials = rare_trials(self.drawing.n_lines, self.chain.sensor.n_pixels)
        return Change(
            *lines.means(),
            moved,
            smoothed_rates(rare, trials, table),
            ratio,
            np.zeros((2, 1)),  # what codes do to the histogram is told by the chance of each
            lines.at_peaks(self.peaks),
            np.zeros(len(ratio)),
        )

    def _simulated(self, effects: Sequence[Effect], draw: int, *, drawn_alone: bool) -> Simulated:
        chain, coded = self.chain, act_on_codes(effects)
        lefts = chain.left_before(effects)
        before_codes = [e for e in effects if e.stage < Stage.CODES]
        return Simulated(
            chain,
            effects,
            [] if drawn_alone else sampled_lines(chain, before_codes, lefts, draw),
            self.drawing.of_both_signs(effects, lefts, draw, coded=coded),
            (self.plain or self).drawing.plain(draw, coded=coded),
            ToneLines.of(chain, effects),
        )

    def _cleaned(self, noisy: NDArray[np.intp]) -> tuple[Counts, Sensor]:
        if len(noisy) == 0:
            return self.counts, self.chain.sensor
        sensor = Sensor(self.chain.sensor.camera, tuple(int(p) for p in noisy))
        return Counts.of(sensor), sensor

    @cached_property
    def moved_dn(self) -> Floats:
        """What the links' means have moved by from what is compared with, (n_blocks, n_pixels)."""
        base = self.chain.baseline
        moved = base.offset_dn + base.slope * base.dose - base.mean_dn
        return (
            moved.reshape(len(moved), -1) if self.plain else np.zeros((len(moved), moved[0].size))
        )

    @cached_property
    def known(self) -> Latest[Change]:
        """What was simulated about this baseline, and about those that follow from it."""
        return Latest(lambda c: c.nbytes, MOST_BYTES) if self.plain is None else self.plain.known

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
    def surroundings(self) -> Latest[Surroundings]:
        """What faults of codes were last looked for among."""
        return Latest(lambda _: 1, KEPT)
