"""What a bench can do, and how long it takes: what a plan costs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from calib.diagnosis.recorded.conditions_table import ConditionsTable
from calib.recording.header import Block


@dataclass(frozen=True)
class BenchTime:
    """A bench as a plan sees it.

    Attributes:
        line_period_us: From line to line, or frame to frame.
        settle_s: Until the light is steady after a change of level.
        block_s: Beside the lines of each block: reading back, the shutter, starting the camera.
        max_level: The highest level of the source; None where it is that of the recording.
        has_monitor: Whether a monitor watches the source; None where nobody knows.
        shows_scenes: Whether a target can be put before the lens.
        target_s: What putting it there, or taking it away, takes.
        starts_in_s: From the end of what was recorded to the plan's first block.
    """

    line_period_us: float
    settle_s: float = 7.0
    block_s: float = 0.5
    max_level: float | None = None
    has_monitor: bool | None = None
    shows_scenes: bool = True
    target_s: float = 60.0
    starts_in_s: float = 60.0


@dataclass(frozen=True)
class Taken:
    """A block of a plan: as recorded, but for its time.

    Attributes:
        block: Its conditions and lines.
        burning: The level that burns, behind the cap of a dark, too.
        wait_s: Before it.
    """

    block: Block
    burning: float
    wait_s: float = 0.0


def at_the_pace_of(table: ConditionsTable, bench: BenchTime) -> BenchTime:
    """Return the bench with the time between blocks that it took when it recorded those of `table`.

    Drifts tell the more, the longer a plan lasts, so that a guess would promise too much.
    """
    ends_s = table.started_s + table.n_lines * table.line_period_us * 1e-6
    pauses_s = table.started_s[1:] - ends_s[:-1]
    if len(pauses_s) == 0:
        return bench
    return replace(bench, block_s=max(float(np.median(pauses_s)), 0.0))


def timed(plan: Sequence[Taken], bench: BenchTime, from_s: float) -> tuple[list[Block], float]:
    """Return the blocks with their starts, and how long it all takes, s.

    Args:
        plan: In the order of acquisition.
        bench: Where.
        from_s: When it begins.
    """
    now, burning, target, blocks = from_s, None, "", []
    for each in plan:
        scene = each.block.scene or ""
        if scene != target:
            now, target = now + bench.target_s, scene
        if each.burning != burning:
            now, burning = now + bench.settle_s, each.burning
        now += each.wait_s + bench.block_s
        blocks.append(each.block.model_copy(update={"started_s": now}))
        now += (each.block.lines or 1) * bench.line_period_us * 1e-6
    return blocks, now - from_s
