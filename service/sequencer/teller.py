"""Passes on where a run stands, and remembers what was said last."""

from dataclasses import replace

from service.sequencer.events import OnProgress, Progress, RunState


class Teller:
    """One per call of `run_plan`."""

    def __init__(self, listener: OnProgress | None, blocks_total: int) -> None:
        self._listener = listener
        self._last = Progress("running", 0, blocks_total, 0, 0, None, "starting")

    def tell(self, progress: Progress) -> None:
        """Pass `progress` on."""
        self._last = progress
        if self._listener is not None:
            self._listener(progress)

    def turn(self, state: RunState, doing: str) -> None:
        """Say that the run is now in `state`, where it stood otherwise unchanged."""
        self.tell(replace(self._last, state=state, doing=doing))
