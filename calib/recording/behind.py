"""Work on frames that is done in a thread of its own while the next frames are read."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Self, TypeVar

Part = TypeVar("Part")


class Behind:
    """Does one part after the other, in order and a few parts behind.

    What a part raises is raised by a later `submit` or by `catch_up`.
    """

    def __init__(self, n_parts: int) -> None:
        """Let at most `n_parts` parts wait: each of them holds memory."""
        self._n_parts = n_parts
        self._thread = ThreadPoolExecutor(1)
        self._waiting: deque[Future[object]] = deque()

    def submit(self, work: Callable[[Part], object], part: Part) -> None:
        """Have `work(part)` done after all that was submitted before."""
        self._wait_for_all_but(self._n_parts - 1)
        self._waiting.append(self._thread.submit(work, part))

    def catch_up(self) -> None:
        """Return once everything is done."""
        self._wait_for_all_but(0)

    def _wait_for_all_but(self, n_parts: int) -> None:
        while len(self._waiting) > n_parts:
            self._waiting.popleft().result()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Give up what has not begun, and end the thread."""
        self._thread.shutdown(wait=True, cancel_futures=True)
