"""The line that in-process mocks do not have: it can still be lost, silent or closed."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Literal

from drivers.errors import DeviceLostError, DeviceTimeoutError

Fault = Literal["none", "lost", "silent"]


class MockLine:
    """One owner's access to a mock.

    Attributes:
        device: The mock's name, for messages.
        fault: "lost" as if unplugged, "silent" as if switched off: every exchange then raises.
            Set it back to "none" to plug in again.
    """

    def __init__(self, device: str) -> None:
        self.device = device
        self.fault: Fault = "none"
        self._closed = False
        self._lock = Lock()

    @contextmanager
    def exchange(self) -> Iterator[None]:
        """Hold the line; raise what the fault makes of it."""
        with self._lock:
            if self._closed:
                raise DeviceLostError(
                    f"{self.device}: closed by this program",
                    device=self.device,
                    code="device-closed",
                )
            if self.fault == "lost":
                raise DeviceLostError(
                    f"{self.device}: gone", device=self.device, code="device-lost"
                )
            if self.fault == "silent":
                raise DeviceTimeoutError(
                    f"{self.device}: no reply", device=self.device, code="device-timeout"
                )
            yield

    def close(self) -> None:
        """End it; safe to call twice."""
        self._closed = True
