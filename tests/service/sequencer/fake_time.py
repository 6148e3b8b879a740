"""A clock that only moves when somebody waits, and a monitor that follows it."""

from collections.abc import Callable

from drivers.ports import DeviceIdentity, MonitorReading


class FakeClock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s

    def wall(self) -> float:
        return 1.8e9 + self.now_s

    def sleep(self, seconds: float) -> None:
        self.now_s += max(seconds, 1e-3)


class ScriptedMonitor:
    """Reads what `current_a` says of the seconds since the clock was made."""

    def __init__(self, clock: FakeClock, current_a: Callable[[float], float]) -> None:
        self._clock = clock
        self._current_a = current_a
        self._started_s = clock.now_s
        self.identity = DeviceIdentity("test", "scripted", "1")

    def read(self) -> MonitorReading:
        self._clock.now_s += 0.05
        return MonitorReading(self._current_a(self._clock.now_s - self._started_s), 0)

    def close(self) -> None:
        """Nothing to release."""
