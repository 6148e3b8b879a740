"""What the bench has seen lately: the last frames' profiles, for whoever looks."""

import threading
from collections import deque

from service.owner.messages import Seen
from service.runs.news import News

MOST_LINES = 120
"""Of the waterfall; older ones fall out of it."""


class Live:
    """Watches the frames and keeps the newest profiles of the newest run. Thread-safe."""

    def __init__(self, news: News) -> None:
        self._news = news
        self._lock = threading.Lock()
        self._seen: deque[Seen] = deque(maxlen=MOST_LINES)
        news.watch(self._look)

    def seen(self) -> tuple[Seen, ...]:
        """Return the profiles, oldest first, all of one run and one width."""
        with self._lock:
            return tuple(self._seen)

    def _look(self) -> None:
        newest = self._news.seen
        if newest is None:
            return
        with self._lock:
            last = self._seen[-1] if self._seen else None
            if newest is last:
                return
            if last is not None and (last.run_id, last.mean_dn.size) != (
                newest.run_id,
                newest.mean_dn.size,
            ):
                self._seen.clear()
            self._seen.append(newest)
