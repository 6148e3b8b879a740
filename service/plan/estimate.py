"""How long a plan takes and how much room its recording needs."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

from service.plan.model import Plan
from service.plan.step import Step

_FRAME_RECORD_BYTES = 512
"""A line of the commit record, generously."""
_FILE_BYTES = 1 << 20
"""Header, features and index of the file, generously."""


_BESIDE_S = 0.5
"""Per block: two readings of the monitor, the shutter, starting the camera; measured over
emulated lines, and about what their baud rates and travels come to."""


@dataclass(frozen=True)
class Estimate:
    """Before anything moves.

    Attributes:
        exposing_s: Lines times their period.
        waiting_s: Ramps, settling, the plan's own waits; at best, a cold lamp takes longer.
        reading_s: Reading lamps and monitor back around each block, over slow lines.
        n_bytes: Upper bound for recording and commit record.
    """

    exposing_s: float
    waiting_s: float
    reading_s: float
    n_bytes: int

    @property
    def total_s(self) -> float:
        """All of it together."""
        return self.exposing_s + self.waiting_s + self.reading_s


def exposing_s(plan: Plan, step: Step) -> float:
    """Return how long the lines of `step` take."""
    return step.lines * plan.camera.line_period_us * 1e-6


def waiting_s(plan: Plan, step: Step, previous: Step | None) -> float:
    """Return how long the lamps take before the lines of `step`, and what the plan waits."""
    lamps = _lamps_set(step, previous)
    settling_s = lamps * plan.lamps.ramp_s + plan.settle.stable_for_s if lamps else 0.0
    return step.wait_s + settling_s


def reading_s(plan: Plan, step: Step, previous: Step | None) -> float:
    """Return how long reading the bench back takes around the lines of `step`.

    Every supply is asked once after the block, and thrice more where the level changes: before
    the ramp, after it, and once the light is steady.
    """
    readings = 4 if _lamps_set(step, previous) else 1
    return readings * plan.lamp_count * plan.lamps.read_back_s + _BESIDE_S


def step_s(plan: Plan, step: Step, previous: Step | None) -> float:
    """Return how long `step` takes at least, all in all."""
    return (
        exposing_s(plan, step) + waiting_s(plan, step, previous) + reading_s(plan, step, previous)
    )


def _lamps_set(step: Step, previous: Step | None) -> int:
    """Return how many lamps are lit or put out before `step`; an LED counts as one."""
    burns = None if previous is None or previous.off_afterwards else previous.burning
    if burns == step.burning:
        return 0
    return max(1, abs(ceil(step.burning) - ceil(burns or 0.0)))


def estimate(
    plan: Plan, steps: Sequence[Step], *, columns: int, rows: int | None = None
) -> Estimate:
    """Return the estimate for `steps` of `plan` on a camera that reads `columns` out.

    `rows` reads an area camera out, whose lines are its frames.
    """
    previous = (None, *steps[:-1])
    lines = sum(step.lines for step in steps)
    bytes_per_code = 1 if plan.camera.bit_depth == 8 else 2
    frames = lines if rows else lines // plan.lines_per_frame
    n_codes = lines * columns * (rows or 1)
    return Estimate(
        exposing_s=sum(exposing_s(plan, step) for step in steps),
        waiting_s=sum(waiting_s(plan, s, p) for s, p in zip(steps, previous, strict=True)),
        reading_s=sum(reading_s(plan, s, p) for s, p in zip(steps, previous, strict=True)),
        n_bytes=n_codes * bytes_per_code + frames * _FRAME_RECORD_BYTES + _FILE_BYTES,
    )
