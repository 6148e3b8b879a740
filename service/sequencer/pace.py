"""How far a run is, and how long it will still take."""

from collections.abc import Sequence
from statistics import median

from service.plan.estimate import step_s
from service.plan.model import Plan
from service.plan.step import Step
from service.sequencer.clock import Clock


class Pace:
    """Adds to the plan's own estimate what a typical step took beyond it so far.

    No plan knows how fast a bench's lines are; a lamp that warmed up for minutes once is no reason
    to expect that of every block, hence the median.
    """

    def __init__(
        self, plan: Plan, steps: Sequence[Step], clock: Clock, left: Sequence[int]
    ) -> None:
        """`left`: the indices of those of all `steps` that are still to do."""
        self.left = list(left)
        self._plan = plan
        self._steps = steps
        self._clock = clock
        self._began_s = self._step_began_s = clock.monotonic()
        self._excess_s: list[float] = []

    @property
    def done(self) -> int:
        """How many steps need not be done any more, of earlier attempts too."""
        return len(self._steps) - len(self.left)

    @property
    def elapsed_s(self) -> float:
        """Since this attempt began."""
        return self._clock.monotonic() - self._began_s

    def finish(self, index: int) -> None:
        """Count the step as done."""
        now_s = self._clock.monotonic()
        self._excess_s.append(now_s - self._step_began_s - self._estimate_s(index))
        self._step_began_s = now_s
        self.left.remove(index)

    def leave_out(self, index: int) -> None:
        """Count the step as done, though it took no time."""
        self.left.remove(index)

    def seconds_left(self) -> float | None:
        """Return the time left; None until a step is done."""
        if not self._excess_s:
            return None
        planned_s = sum(self._estimate_s(index) for index in self.left)
        return max(0.0, planned_s + len(self.left) * median(self._excess_s))

    def _estimate_s(self, index: int) -> float:
        step = self._steps[index]
        previous = self._steps[index - 1] if index else None
        return step_s(self._plan, step, previous)
