"""Persistence: traps catch a little of each line's charge and give it back over seconds.

Source: Smith et al., A theory for image persistence in HgCdTe photodiodes, Proc. SPIE 7021, 70210J
(2008), and Tulloch and George, Predictive model of persistence in H2RG detectors, J. Astron.
Telesc. Instrum. Syst. 5 (2019): each kind of trap fills and empties as a filter of one pole, and
there are so many traps and no more, so that persistence levels off with the charge collected.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp
from typing import Any, ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.forward.conditions import Conditions
from calib.forward.departure import Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import darker_after_brighter
from calib.forward.remembering import LineByLine
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Persistence(LineByLine):
    """Catch a share a of each line's charge, by free traps; release it with a time constant T.

    Traps that hold H electrons give back H (1 - exp(-P / T)) during a line period P, which are
    read with that line; what they release between blocks is lost. A pixel has a F traps. A line of
    q electrons fills 1 - exp(-q / F) of those that are free: of slow ones, light of F electrons in
    all fills 1 - 1 / e, in one line or in many. While traps fill, lines are too dark; when as many
    electrons are released as caught, steady light is read in full. A line that comes t after light
    that left H in the traps is H P / T exp(-t / T) too bright, for P << T. Electrons are caught and
    released each by itself. Of an area sensor, lines are frames.

    Attributes:
        share: a, 0 for none.
        time_constant_s: T.
        filled_by_e: F; so large that traps never fill unless said.
    """

    name: ClassVar[str] = "persistence"
    stage: ClassVar[Stage] = Stage.TRANSFER
    stochastic: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Traps catch a share of the charge and leak it into later lines and blocks, exp(-t/T)."
    )
    shows_in: ClassVar[Statistic] = "transient"
    depends_on: ClassVar[tuple[Variable, ...]] = ("previous_block", "time")

    share: float = parameter(0.005, unit="1", low=0.0, high=0.5, neutral=0.0)
    time_constant_s: float = parameter(5.0, unit="s", low=1e-3, high=1e5)
    filled_by_e: float = parameter(1e12, unit="e-", low=1.0, high=1e12)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show persistence; None where it could."""
        return darker_after_brighter(blocks)

    def carried(
        self, signal: Lines, found: NDArray[Any], at: Conditions, rng: Generator
    ) -> tuple[Lines, Pixels]:
        """Electrons in and out, (n_lines, *sample), and what the traps hold, (*sample,)."""
        held = found
        released_share = -np.expm1(-at.line_period_us * 1e-6 / self.time_constant_s)
        whole = np.rint(np.maximum(signal, 0.0)).astype(np.int64)
        read = np.empty(signal.shape)
        for n, line in enumerate(whole):
            released = rng.binomial(held, released_share)
            caught = rng.binomial(line, self._caught(line, held - released) / np.maximum(line, 1))
            held = held + caught - released
            read[n] = signal[n] + (released - caught)
        return read, held.astype(np.float64)

    def _caught(self, line: NDArray[Any], held: NDArray[Any]) -> Pixels:
        """Return the electrons that free traps catch of a line's on average, (*sample,)."""
        free = np.maximum(self.share * self.filled_by_e - held, 0.0)
        return np.asarray(free * -np.expm1(-line / self.filled_by_e))

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:
        """Return the electrons that the traps hold, (*sample,)."""
        kept_share = exp(-at.line_period_us * 1e-6 / self.time_constant_s)
        kept = self._kept(at)
        held = np.zeros(signal.shape[1:]) if kept is None else kept
        light = np.maximum(signal, 0.0)
        if len(light) > 1:
            for line in light:
                held = kept_share * held
                held = held + self._caught(line, held)
            return held
        # Steady light: what differs from the balance goes by the same factor with each line.
        filled = -np.expm1(-light[0] / self.filled_by_e)
        factor = kept_share * (1.0 - filled)
        balance = self.share * self.filled_by_e * filled / (1.0 - factor)
        return np.asarray(balance + (held - balance) * factor**at.n_lines)

    def _kept(self, at: Conditions) -> Pixels | None:
        """Return what the traps still hold when the first line starts, (*sample,)."""
        held = at.left_by(self.name)
        return None if held is None else held * exp(-at.idle_s / self.time_constant_s)

    def found(self, sample: tuple[int, ...], at: Conditions, rng: Generator) -> NDArray[np.int64]:
        """Return the whole electrons in the traps when the first line starts, (*sample,)."""
        held, kept = at.left_by(self.name), self._kept(at)
        if at.before is None or held is None or kept is None:
            return np.zeros(sample, np.int64)
        if at.before.drawn:
            decayed = exp(-at.idle_s / self.time_constant_s)
            return np.asarray(rng.binomial(held.astype(np.int64), decayed))
        return np.asarray(rng.poisson(kept))
