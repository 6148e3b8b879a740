"""The monitor photodiode: triggered, then read."""

from drivers.ports import Monitor, MonitorReading
from service.bluesky.documents import DataKey, Reading, number, reading
from service.bluesky.work_status import WorkStatus


class BenchMonitor:
    """Triggerable and readable.

    Attributes:
        name: Of the device in documents.
        parent: None, as for every device that stands alone.
    """

    parent = None

    def __init__(self, monitor: Monitor, source: str, name: str = "monitor_current") -> None:
        self.name = name
        self._monitor = monitor
        self._source = source
        self._last: MonitorReading | None = None

    def trigger(self) -> WorkStatus:
        """Measure once."""

        def measure() -> None:
            self._last = self._monitor.read()

        return WorkStatus(measure, self.name)

    def read(self) -> dict[str, Reading]:
        """Return what was measured last; measured now where nothing was."""
        last = self._monitor.read() if self._last is None else self._last
        return {self.name: reading(last.current_a, last.host_timestamp_ns * 1e-9)}

    def describe(self) -> dict[str, DataKey]:
        """Describe what `read` gives."""
        return {self.name: number(self._source, "A")}
