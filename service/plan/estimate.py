"""How long a plan takes and how much room its recording needs."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.plan.model import Plan
from service.plan.step import Step

_FRAME_RECORD_BYTES = 512
"""A line of the commit record, generously."""
_FILE_BYTES = 1 << 20
"""Header, features and index of the file, generously."""


@dataclass(frozen=True)
class Estimate:
    """Before anything moves.

    Attributes:
        exposing_s: Lines times their period.
        waiting_s: Ramps, settling, the plan's own waits; at best, a cold lamp takes longer.
        n_bytes: Upper bound for recording and commit record.
    """

    exposing_s: float
    waiting_s: float
    n_bytes: int

    @property
    def total_s(self) -> float:
        """Both together."""
        return self.exposing_s + self.waiting_s


def exposing_s(plan: Plan, step: Step) -> float:
    """Return how long the lines of `step` take."""
    return step.lines * plan.camera.line_period_us * 1e-6


def waiting_s(plan: Plan, step: Step, previous: Step | None) -> float:
    """Return how long the lamps take before the lines of `step`, and what the plan waits."""
    unchanged = (
        previous is not None and previous.burning == step.burning and not previous.off_afterwards
    )
    settling_s = 0.0 if unchanged else plan.lamps.ramp_s + plan.settle.stable_for_s
    return step.wait_s + settling_s


def estimate(plan: Plan, steps: Sequence[Step], *, columns: int) -> Estimate:
    """Return the estimate for `steps` of `plan` on a camera that reads `columns` out."""
    previous = (None, *steps[:-1])
    lines = sum(step.lines for step in steps)
    bytes_per_code = 1 if plan.camera.bit_depth == 8 else 2
    frames = lines // plan.lines_per_frame
    return Estimate(
        exposing_s=sum(exposing_s(plan, step) for step in steps),
        waiting_s=sum(waiting_s(plan, s, p) for s, p in zip(steps, previous, strict=True)),
        n_bytes=lines * columns * bytes_per_code + frames * _FRAME_RECORD_BYTES + _FILE_BYTES,
    )
