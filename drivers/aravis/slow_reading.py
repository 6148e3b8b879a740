"""A value that changes slowly and costs a round trip to the camera."""

import time
from collections.abc import Callable


class SlowReading:
    """Read at most once a second while frames stream: control is answered between frames."""

    def __init__(self, read: Callable[[], float | None], *, refresh_s: float = 1.0) -> None:
        self._read = read
        self._refresh_s = refresh_s
        self._value: float | None = None
        self._due_s = 0.0

    def now(self) -> float | None:
        """Read it now."""
        self._value = self._read()
        self._due_s = time.monotonic() + self._refresh_s
        return self._value

    def recent(self) -> float | None:
        """Return the latest reading, read anew where it is older than a second."""
        return self.now() if time.monotonic() >= self._due_s else self._value
