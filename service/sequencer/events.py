"""What a run says while it goes on, and how it ended."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from calib.arrays import Columns

RunState = Literal[
    "running", "paused", "aborting", "succeeded", "failed", "cancelled", "interrupted"
]
"""`interrupted`: found after a crash. The last four are final: the bench is dark and free."""

FINAL: frozenset[RunState] = frozenset({"succeeded", "failed", "cancelled", "interrupted"})


@dataclass(frozen=True)
class Progress:
    """Where a run stands.

    Attributes:
        state: A final one is said only once the lamps are off and the file is closed.
        blocks_done: Committed or left out, of `blocks_total`; of earlier attempts too.
        blocks_total: Of the plan.
        frames: Whole frames committed in this attempt.
        lost_frames: Lost and taken again, in this attempt.
        seconds_left: By the rate measured so far; None where nothing was measured yet.
        doing: What goes on now, for a person.
    """

    state: RunState
    blocks_done: int
    blocks_total: int
    frames: int
    lost_frames: int
    seconds_left: float | None
    doing: str


@dataclass(frozen=True)
class LiveColumns:
    """What one frame looks like, for a page: cheap, from a part of its lines.

    Attributes:
        block: Its block's name.
        mean_dn: Mean code per column, (n_columns,).
    """

    block: str
    mean_dn: Columns


@dataclass(frozen=True)
class RunResult:
    """How a run ended that ended without an error.

    Attributes:
        state: `succeeded` or `cancelled`.
        path: The recording; what is committed can be read in any case.
        blocks_done: Committed, of `blocks_total`.
        skipped: Blocks that the saturation look-ahead left out.
        frames: Committed in this attempt.
        lost_frames: In this attempt.
        notes: What a person should know of, one sentence each.
        seconds: What this attempt took.
    """

    state: RunState
    path: Path
    blocks_done: int
    blocks_total: int
    skipped: tuple[str, ...]
    frames: int
    lost_frames: int
    notes: tuple[str, ...]
    seconds: float


OnProgress = Callable[[Progress], None]
OnColumns = Callable[[LiveColumns], None]
