"""RTS pixels: the output of a few pixels jumps between two levels, whatever the exposure.

Source: Kirton and Uren, Noise in solid-state microstructures, Adv. Phys. 38, 367 (1989): one trap
near the source follower's channel, a Markov process with a mean dwell time in each level; Wang et
al., Random telegraph signal in CMOS image sensor pixels, IEDM (2006), for pixels.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, prod
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.forward.conditions import Conditions
from calib.forward.departure import Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import pattern_generator
from calib.forward.plan_needs import lines
from calib.forward.remembering import Remembering
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class RtsPixels(Remembering):
    """Raise the output of some pixels while their trap is in its upper level.

    A pixel is up for the share u = dwell_up / (dwell_up + dwell_down) of the time. Its variance is
    amplitude^2 u (1 - u), its autocorrelation exp(-t (1 / dwell_up + 1 / dwell_down)). Levels are
    those at the lines' starts, and run on from frame to frame of a block; a block that is simulated
    without the ones before starts from levels drawn anew.

    Attributes:
        amplitude_dn: Height of the jumps.
        share: Of all pixels; at least one jumps where it is above 0.
        dwell_up_s, dwell_down_s: Mean time in each level.
        pattern_seed: Which sensor of that kind it is: where its pixels are.
    """

    name: ClassVar[str] = "rts_pixels"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = True
    physics: ClassVar[str] = "The output of a few pixels jumps between two levels at random times."
    shows_in: ClassVar[Statistic] = "histogram"
    depends_on: ClassVar[tuple[Variable, ...]] = ("column", "time")

    amplitude_dn: float = parameter(5.0, unit="DN", low=0.0, high=1e5, neutral=0.0)
    share: float = parameter(0.01, unit="1", low=0.0, high=1.0, neutral=0.0)
    dwell_up_s: float = parameter(1e-3, unit="s", low=1e-9, high=1e9)
    dwell_down_s: float = parameter(1e-3, unit="s", low=1e-9, high=1e9)
    pattern_seed: int = parameter(0, unit="1", low=0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show jumps; None where it could."""
        return lines(blocks, 3)

    @property
    def up_share(self) -> float:
        """The share of the time in the upper level."""
        return self.dwell_up_s / (self.dwell_up_s + self.dwell_down_s)

    def carry(self, signal: Lines, at: Conditions, rng: Generator) -> tuple[Lines, Pixels]:
        """DN in and out, (n_lines, *sample), and 1 for pixels left in the upper level."""
        sample = signal.shape[1:]
        where = self.pixels(sample)
        found = at.left_by(self.name)
        old = None if found is None else found.ravel()[where] > rng.random(where.size)
        levels = self._levels(old, at, where.size, rng)
        out = np.array(signal, np.float64)
        out.reshape(len(out), -1)[:, where] += self.amplitude_dn * levels
        left = np.zeros(prod(sample))
        left[where] = levels[-1]
        return out, left.reshape(sample)

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:  # noqa: ARG002
        """Return the probability of the upper level for pixels that jump, (*sample,)."""
        sample = signal.shape[1:]
        left = np.zeros(prod(sample))
        left[self.pixels(sample)] = self.up_share
        return left.reshape(sample)

    def pixels(self, sample: tuple[int, ...]) -> NDArray[np.intp]:
        """Return which pixels jump, counted row by row, ascending, read-only."""
        return _chosen(self.pattern_seed, self.name, prod(sample), self.share)

    def _levels(
        self, old: NDArray[np.bool_] | None, at: Conditions, n: int, rng: Generator
    ) -> NDArray[np.bool_]:
        """Return the levels of `n` pixels, (n_lines, n), where they were in `old` before.

        After a time t, a trap is where it was with probability exp(-t rate), else at equilibrium.
        """
        rate_hz = 1.0 / self.dwell_up_s + 1.0 / self.dwell_down_s
        steps = np.full((at.n_lines, 1), at.line_period_us * 1e-6)
        steps[0] += at.idle_s
        forgets = rng.random((at.n_lines, n)) < -np.expm1(-steps * rate_hz)
        fresh = rng.random((at.n_lines, n)) < self.up_share
        first = fresh[0] if old is None else np.where(forgets[0], fresh[0], old)
        fresh[0] = first
        forgets[0] = True
        last = np.maximum.accumulate(np.where(forgets, np.arange(at.n_lines)[:, np.newaxis], 0))
        return np.asarray(np.take_along_axis(fresh, last, axis=0))


@lru_cache(maxsize=16)
def _chosen(seed: int, name: str, n_pixels: int, share: float) -> NDArray[np.intp]:
    chosen = pattern_generator(seed, name).permutation(n_pixels)[: ceil(share * n_pixels)]
    chosen.sort()
    chosen.flags.writeable = False
    return chosen
