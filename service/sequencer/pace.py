"""How far a run is, and how long it will still take."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from service.plan.estimate import exposing_s, waiting_s
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.clock import Clock


@dataclass
class Pace:
    """Scales the plan's own estimate by what was measured so far.

    Attributes:
        plan: What is run.
        steps: All of its steps.
        clock: Measures.
        left: Indices of the steps still to do.
    """

    plan: Plan
    steps: Sequence[Step]
    clock: Clock
    left: list[int]
    _began_s: float = field(init=False)
    _done_estimate_s: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        self._began_s = self.clock.monotonic()

    @property
    def done(self) -> int:
        """How many steps need not be done any more, of earlier attempts too."""
        return len(self.steps) - len(self.left)

    @property
    def elapsed_s(self) -> float:
        """Since this attempt began."""
        return self.clock.monotonic() - self._began_s

    def finish(self, index: int) -> None:
        """Count the step as done."""
        self._done_estimate_s += self._estimate_s(index)
        self.left.remove(index)

    def leave_out(self, index: int) -> None:
        """Count the step as done, though it took no time."""
        self.left.remove(index)

    def seconds_left(self) -> float | None:
        """Return the time left; None until a step is done."""
        if self._done_estimate_s == 0:
            return None
        rate = self.elapsed_s / self._done_estimate_s
        return rate * sum(self._estimate_s(index) for index in self.left)

    def _estimate_s(self, index: int) -> float:
        step = self.steps[index]
        previous = self.steps[index - 1] if index else None
        return exposing_s(self.plan, step) + waiting_s(self.plan, step, previous)
