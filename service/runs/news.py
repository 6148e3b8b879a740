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
        self._watchers: set[OnNews] = set()
        self.told = 0
        self.seen: Seen | None = None

    def follow(self, wake: OnNews) -> Callable[[], None]:
        """Call `wake`, which must not block, at each news; return what ends that."""
        return self._enter(self._followers, wake)

    def watch(self, wake: OnNews) -> Callable[[], None]:
        """Call `wake`, which must not block, at each frame's look; return what ends that."""
        return self._enter(self._watchers, wake)

    def tell(self) -> None:
        """Wake all followers."""
        with self._lock:
            self.told += 1
            followers = tuple(self._followers)
        for wake in followers:
            wake()

    def show(self, seen: Seen) -> None:
        """Keep what a frame looks like, and wake those who watch."""
        self.seen = seen
        with self._lock:
            watchers = tuple(self._watchers)
        for wake in watchers:
            wake()

    def _enter(self, those: set[OnNews], wake: OnNews) -> Callable[[], None]:
        with self._lock:
            those.add(wake)

        def leave() -> None:
            with self._lock:
                those.discard(wake)

        return leave
