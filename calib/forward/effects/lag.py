"""Lag: a share of a pixel's charge stays behind when a line is read, and comes with the next.

Source: Fossum and Hondongwa, A review of the pinned photodiode for CCD and CMOS image sensors, IEEE
J. Electron Devices Soc. 2, 33 (2014), section on lag: incomplete transfer over a barrier. For
photodiodes that are reset softly: Pain et al. (1999), see `calib.forward.partition`, which also
says why lag of independent electrons shows only where the light changes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.forward.conditions import Conditions
from calib.forward.departure import Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.partition import part_of
from calib.forward.plan_needs import flats
from calib.forward.remembering import LineByLine, sum_over_lines
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Lag(LineByLine):
    """Hold back a share f of the charge, that of the line before included, for the next line.

    In steady light of m electrons, f m / (1 - f) stay and m are read. After a step from m to m',
    line n from 0 is f^(n+1) (m - m') off. The next line may be that of the next block: charge waits
    in the pixel until it is read. Of an area sensor, lines are frames. With partition noise p,
    lines at distance d >= 1 covary by (1 - p^2) f^d (1 - f) / (1 + f) m.

    Attributes:
        share: f, 0 for none.
        partition_noise: 1 where each electron stays or goes by itself, 0 where exactly the share
            stays.
    """

    name: ClassVar[str] = "lag"
    stage: ClassVar[Stage] = Stage.TRANSFER
    stochastic: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "A share f of a line's charge stays in the pixels and is read with the next line."
    )
    shows_in: ClassVar[Statistic] = "transient"
    depends_on: ClassVar[tuple[Variable, ...]] = ("previous_block", "line", "signal")
    any_law: ClassVar[Variable | None] = "signal"

    share: float = parameter(0.01, unit="1", low=0.0, high=0.9, neutral=0.0)
    partition_noise: float = parameter(1.0, unit="1", low=0.0, high=1.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show lag; None where it could."""
        return flats(blocks, lines=2)

    def carried(
        self,
        signal: Lines,
        found: NDArray[Any],
        at: Conditions,  # noqa: ARG002
        rng: Generator,
    ) -> tuple[Lines, Pixels]:
        """Electrons in and out, (n_lines, *sample), and what stays of the last line, (*sample,)."""
        kept = found
        read = np.empty(signal.shape)
        for n, line in enumerate(signal):
            charge = line + kept
            kept = part_of(charge, self.share, self.partition_noise, rng)
            read[n] = charge - kept
        return read, kept

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:
        """Return the electrons that stay, (*sample,)."""
        ago = np.arange(at.n_lines, 0, -1)
        kept = sum_over_lines(self.share**ago, signal)
        before = at.left_by(self.name)
        return kept if before is None else kept + before * self.share**at.n_lines

    def found(self, sample: tuple[int, ...], at: Conditions, rng: Generator) -> Pixels:
        """Return the charge in the pixels before the first line, (*sample,)."""
        kept = at.left_by(self.name)
        if at.before is None or kept is None:
            return np.zeros(sample)
        if at.before.drawn:
            return kept
        # In steady light, f m / (1 - f) stay with a variance of (f + p^2) / (1 + f) times that.
        drawn = rng.poisson(kept)
        relative_variance = (self.share + self.partition_noise**2) / (1.0 + self.share)
        return np.asarray(kept + np.sqrt(relative_variance) * (drawn - kept))
