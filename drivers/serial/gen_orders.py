"""Orders to go off, which overtake whatever another thread does with the lamps."""

from contextlib import suppress
from threading import Event

from drivers.errors import DeviceError
from drivers.serial.link import SerialLink


class OffOrders:
    """Counts them: who began before the last one has to stop. Thread-safe.

    Attributes:
        count: How many there were.
    """

    def __init__(self, link: SerialLink) -> None:
        self.count = 0
        self._link = link
        self._came = Event()

    def give(self) -> None:
        """Send the group command, whoever uses the line."""
        self.count += 1
        self._came.set()
        with suppress(DeviceError):  # it is sent again, with the lock held, and read back
            self._link.interject("GOUT OFF")

    def begin(self) -> int:
        """Return how many there were, for something that each further one stops."""
        with self._link.lock:
            self._came.clear()
            return self.count

    def check(self, count: int) -> None:
        """Raise DeviceError `switched-off` where there was one since there were `count`."""
        if self.count != count:
            device = self._link.device
            raise DeviceError(
                f"{device}: switched off while the lamps were being set or read",
                device=device,
                code="switched-off",
            )

    def wait(self, longest_s: float) -> None:
        """Wait for the next one, or so long."""
        self._came.wait(longest_s)
