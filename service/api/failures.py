"""Keys that were tried and are none."""

import time


class Failures:
    """Slows down who tries keys: each failure from one address doubles the next wait."""

    _FIRST_S = 0.1
    _LONGEST_S = 5.0
    _FORGOTTEN_S = 300.0
    _MOST = 10_000

    def __init__(self) -> None:
        self._last: dict[str, tuple[int, float]] = {}

    def wait_s(self, address: str) -> float:
        """Return how long the next try from there has to wait."""
        count, at_s = self._last.get(address, (0, 0.0))
        if count == 0 or time.monotonic() - at_s > self._FORGOTTEN_S:
            return 0.0
        return float(min(self._FIRST_S * 2.0 ** (count - 1), self._LONGEST_S))

    def count(self, address: str) -> None:
        """Remember a failure."""
        if len(self._last) >= self._MOST:
            self._last.pop(next(iter(self._last)))
        self._last[address] = (self._last.pop(address, (0, 0.0))[0] + 1, time.monotonic())

    def forget(self, address: str) -> None:
        """Somebody there has a good key."""
        self._last.pop(address, None)
