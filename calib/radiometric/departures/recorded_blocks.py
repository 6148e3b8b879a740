"""Under which conditions a recording's lines were exposed, as its header tells."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.left import Left
from calib.forward.schedule import AMBIENT_C
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class RecordedBlock:
    """A block and what the chain has to know of it.

    Attributes:
        block: As the header has it.
        n_lines: All its lines, those held out included.
        started_s: Since the recording's start; where the header does not tell, as if each block
            had followed on the one before.
        line_period_us: From line to line.
        gain_db: As the camera was set.
    """

    block: Block
    n_lines: int
    started_s: float
    line_period_us: float
    gain_db: float

    @property
    def ended_s(self) -> float:
        """When the last line's period is over."""
        return self.started_s + self.n_lines * self.line_period_us * 1e-6

    def at(self, before: Left | None, first: int, stop: int) -> Conditions:
        """Return what holds during lines `first` to `stop`, which find `before` in the pixels.

        What burns enters as the level alone: how much light that is, the recording says.
        """
        temperature_c = self.block.sensor_temperature_c
        lines = np.arange(first, stop, dtype=np.float64)
        return Conditions(
            exposure_us=self.block.exposure_us,
            line_period_us=self.line_period_us,
            line_times_s=self.started_s + lines * (self.line_period_us * 1e-6),
            lamps=(self.block.level,),
            level=self.block.level,
            capped=self.block.kind == "dark",
            sensor_temperature_c=AMBIENT_C if temperature_c is None else temperature_c,
            gain_db=self.gain_db,
            before=before,
        )


def recorded_blocks(
    blocks: Sequence[Block], n_lines: Sequence[int], camera: CameraHeader, known_us: float | None
) -> tuple[RecordedBlock, ...]:
    """Return the blocks, in the order of time, with the times that they do not tell.

    Args:
        blocks: Of the recording.
        n_lines: How many lines each has.
        camera: The recording's.
        known_us: The model's line period, for a recording that does not tell its own.

    Raises:
        InputError: `line-period-missing` where nobody tells it.
    """
    period_us = camera.line_period_us or known_us
    if period_us is None:
        raise InputError(
            "Neither the recording nor the model states camera.line_period_us, which tells when "
            "each line was taken: add it to either.",
            code="line-period-missing",
        )
    found: list[RecordedBlock] = []
    for block, n in zip(blocks, n_lines, strict=True):
        free_s = found[-1].ended_s if found else 0.0
        started_s = free_s if block.started_s is None else block.started_s
        found.append(RecordedBlock(block, n, started_s, period_us, camera.gain_db))
    return tuple(found)
