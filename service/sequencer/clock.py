"""Time, so that tests need not wait for lamps."""

import time
from typing import Protocol

from drivers.ports import Cancelled

_SLICE_S = 0.2


class Clock(Protocol):
    """What the sequencer asks of time."""

    def monotonic(self) -> float:
        """Return seconds that never go back, from an arbitrary start."""
        ...

    def wall(self) -> float:
        """Return Unix time in seconds."""
        ...

    def sleep(self, seconds: float) -> None:
        """Wait."""
        ...


class SystemClock:
    """The machine's own."""

    def monotonic(self) -> float:
        """Return seconds that never go back."""
        return time.monotonic()

    def wall(self) -> float:
        """Return Unix time in seconds."""
        return time.time()

    def sleep(self, seconds: float) -> None:
        """Wait."""
        time.sleep(seconds)


def wait(seconds: float, clock: Clock, cancelled: Cancelled) -> None:
    """Wait in slices, so that a cancellation is noticed; return early when it is."""
    until = clock.monotonic() + seconds
    while not cancelled() and (left := until - clock.monotonic()) > 0:
        clock.sleep(min(left, _SLICE_S))
