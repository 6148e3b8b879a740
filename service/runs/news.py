"""Wakes those who follow what happens; what happened they read from the journal."""

import threading
from collections.abc import Callable

from service.owner.messages import Seen

OnNews = Callable[[], None]


class News:
    """Tells followers that something is new, from any thread; keeps the newest frame's look.

    Attributes:
        told: How often something was new. What is read after looking at it holds all of that.
        seen: The newest frame's look.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._followers: set[OnNews] = set()
        self.told = 0
        self.seen: Seen | None = None

    def follow(self, wake: OnNews) -> Callable[[], None]:
        """Call `wake`, which must not block, at each news; return what ends that."""
        with self._lock:
            self._followers.add(wake)

        def leave() -> None:
            with self._lock:
                self._followers.discard(wake)

        return leave

    def tell(self) -> None:
        """Wake all followers."""
        with self._lock:
            self.told += 1
            followers = tuple(self._followers)
        for wake in followers:
            wake()

    def show(self, seen: Seen) -> None:
        """Keep what a frame looks like, and wake."""
        self.seen = seen
        self.tell()
