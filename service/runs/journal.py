"""Which of what a run says is worth keeping: what changed, and a few words a second."""

import time
from dataclasses import asdict

from service.runs.news import News
from service.sequencer.events import Progress
from service.store.runs import Runs

_APART_S = 0.25
"""A page needs no more, and each word is synced to the disk."""


class Journal:
    """Keeps one run's progress in the store. Used by one thread."""

    def __init__(self, runs: Runs, news: News) -> None:
        self._runs = runs
        self._news = news
        self._last: Progress | None = None
        self._at_s = 0.0

    def keep(self, run_id: str, progress: Progress) -> None:
        """Put `progress` on record where it says something new, not too often."""
        last, now_s = self._last, time.monotonic()
        steps_on = last is None or last.blocks_done != progress.blocks_done
        if not steps_on and (progress == last or now_s - self._at_s < _APART_S):
            return
        self._last, self._at_s = progress, now_s
        content = {name: value for name, value in asdict(progress).items() if name != "state"}
        self._runs.progress(run_id, "progress", content)
        self._news.tell()

    def begin(self) -> None:
        """Forget the run before."""
        self._last = None
