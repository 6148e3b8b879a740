"""Persistence: traps catch a little of each line's charge and give it back over seconds.

Source: Smith et al., A theory for image persistence in HgCdTe photodiodes, Proc. SPIE 7021, 70210J
(2008), and Tulloch and George, Predictive model of persistence in H2RG detectors, J. Astron.
Telesc. Instrum. Syst. 5 (2019): each kind of trap fills and empties as a filter of one pole.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, expm1
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
from calib.forward.remembering import LineByLine, sum_over_lines
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Persistence(LineByLine):
    """Catch a share a of each line's charge; release what is caught with a time constant T.

    Traps that hold H electrons give back H (1 - exp(-P / T)) during a line period P, which are
    read with that line; what they release between blocks is lost. So no charge is lost within a
    block, steady light is read in full, and a line that comes t after lines of m electrons that
    lasted D >> P is a m (1 - exp(-D / T)) exp(-t / T) too bright, for P << T. Electrons are caught
    and released each by itself. Of an area sensor, lines are frames.

    Attributes:
        share: a, 0 for none.
        time_constant_s: T.
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

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show persistence; None where it could."""
        return darker_after_brighter(blocks)

    def carried(
        self, signal: Lines, found: NDArray[Any], at: Conditions, rng: Generator
    ) -> tuple[Lines, Pixels]:
        """Electrons in and out, (n_lines, *sample), and what the traps hold, (*sample,)."""
        held = found
        released_share = -expm1(-at.line_period_us * 1e-6 / self.time_constant_s)
        whole = np.rint(np.maximum(signal, 0.0)).astype(np.int64)
        read = np.empty(signal.shape)
        for n, line in enumerate(whole):
            released = rng.binomial(held, released_share)
            caught = rng.binomial(line, self.share)
            held = held + caught - released
            read[n] = signal[n] + (released - caught)
        return read, held.astype(np.float64)

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:
        """Return the electrons that the traps hold, (*sample,)."""
        kept_share = exp(-at.line_period_us * 1e-6 / self.time_constant_s)
        ago = np.arange(at.n_lines)[::-1]
        caught = sum_over_lines(self.share * kept_share**ago, signal)
        kept = self._kept(at)
        return caught if kept is None else caught + kept * kept_share**at.n_lines

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
