"""Duplicated lines: now and then a line is sent again in place of the one that follows.

Source: GigE Vision 2.0, packet resend, and frame grabbers that find no new line in their buffer
and hand out the old one; here as independent events.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels
from calib.forward.conditions import Conditions
from calib.forward.departure import Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import lines
from calib.forward.remembering import Remembering
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class DuplicatedLines(Remembering):
    """Put the line before in place of a line, of an area sensor a frame; their number stays.

    A line whose predecessor is not the one before it in time, such as the first of a block, is
    never a duplicate.

    Attributes:
        probability: That a line is one.
    """

    name: ClassVar[str] = "duplicated_lines"
    stage: ClassVar[Stage] = Stage.TRANSPORT
    stochastic: ClassVar[bool] = True
    physics: ClassVar[str] = "Now and then a line is sent twice, in place of the one that follows."
    shows_in: ClassVar[Statistic] = "line_covariance"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line",)

    probability: float = parameter(0.01, unit="1", low=0.0, high=0.9, neutral=0.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show duplicates; None where it could."""
        return lines(blocks, 2)

    def carry(self, signal: Lines, at: Conditions, rng: Generator) -> tuple[Lines, Pixels]:
        """Codes in and out, (n_lines, *sample), and the last line sent, (*sample,)."""
        again = rng.random(len(signal)) < self.probability
        before = at.left_by(self.name) if at.follows_on else None
        repeats_first = bool(again[0]) and before is not None
        again[0] = False
        source = np.maximum.accumulate(np.where(again, 0, np.arange(len(signal))))
        sent = np.asarray(signal[source])
        if repeats_first:
            sent[source == 0] = before
        return sent, sent[-1].copy()

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:  # noqa: ARG002
        """Return the last line; no draw that finds an expectation repeats it."""
        return np.asarray(signal[-1], np.float64)
