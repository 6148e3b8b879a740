"""How far a run is: its journal read on, and that in words."""

from collections import deque
from dataclasses import dataclass

from service.store.run_records import RunEvent, RunRecord
from service.store.runs import Runs

_MOST_EVENTS = 200


class Tail:
    """Reads on in a run's journal and keeps the newest of it; used by one thread at a time."""

    def __init__(self, runs: Runs, run_id: str) -> None:
        self.run_id = run_id
        self.events: deque[RunEvent] = deque(maxlen=_MOST_EVENTS)
        self.progress: RunEvent | None = None
        self._runs = runs
        self._after = 0

    def read_on(self) -> bool:
        """Read what is new; tell whether anything is."""
        before = self._after
        while new := self._runs.events(self.run_id, after=self._after):
            self._after = new[-1].number
            self.events.extend(new)
            self.progress = next((e for e in reversed(new) if e.kind == "progress"), self.progress)
        return self._after > before


@dataclass(frozen=True)
class Stand:
    """Where a run stands: the share of its blocks, and a sentence."""

    share: float
    text: str


def stand(run: RunRecord, progress: RunEvent | None = None) -> Stand:
    """Return where `run` stands; `progress` is the newest of what it said of that."""
    share = run.blocks_done / run.blocks_total if run.blocks_total else 0.0
    text = f"{run.state}, {run.blocks_done} of {run.blocks_total} blocks"
    if progress is None or run.state != "running":  # what it did before is over
        return Stand(share, text)
    left, doing = progress.content.get("seconds_left"), str(progress.content.get("doing") or "")
    words = (text, "" if left is None else f"{duration(left)} left", doing)
    return Stand(share, ", ".join(word for word in words if word))


def name_of(run: RunRecord) -> str:
    """Return what a person calls a run."""
    return str(run.plan.get("name") or run.id[:8])


def duration(seconds: float) -> str:
    """Return a time span as a person says it.

    >>> duration(75.0), duration(600.0), duration(7200.0)
    ('75 s', '10 min', '2.0 h')
    """
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
