"""Bytes in and out of one serial port, held exclusively; whatever fails is a DeviceError."""

import errno
import termios
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import serial

from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceNotFoundError,
    DeviceTimeoutError,
)

_POLL_S = 0.02  # how long one read blocks; deadlines are kept to this
_SHOWN_BYTES = 80
_LINE_FAILURES = (serial.SerialException, OSError, termios.error)
"""What pyserial lets through when a device is unplugged: all three were seen."""
_BUSY = (DeviceBusyError, "device-busy", "held by another program; stop that first")
_ABSENT = (DeviceNotFoundError, "device-not-found", "no such port; is it plugged in?")
_FORBIDDEN = (DeviceError, "device-forbidden", "not allowed; join the group dialout")
_REFUSALS: dict[object, tuple[type[DeviceError], str, str]] = {
    errno.EAGAIN: _BUSY,
    errno.EBUSY: _BUSY,
    errno.ENOENT: _ABSENT,
    errno.ENXIO: _ABSENT,
    errno.ENODEV: _ABSENT,
    errno.EIO: _ABSENT,
    errno.EACCES: _FORBIDDEN,
    errno.EPERM: _FORBIDDEN,
}


@dataclass(frozen=True)
class PortSettings:
    """Where a device is and how its line is set (8 data bits, no parity, 1 stop bit).

    Attributes:
        address: The port's path; a link that stays the same when the device is plugged in again
            (/dev/serial/by-id/...) lets a lost device be found again.
        name: What the bench file calls the device.
        baudrate: Bits per second.
        write_timeout_s: How long the device may refuse to take bytes.
    """

    address: str
    name: str
    baudrate: int
    write_timeout_s: float = 0.4

    @property
    def device(self) -> str:
        """Name and address, for messages."""
        return f"{self.name} at {self.address}"


class SerialPort:
    """The port, what arrived since the last question, and the last bytes exchanged."""

    def __init__(self, settings: PortSettings) -> None:
        """Open the port.

        Raises:
            DeviceNotFoundError: There is no such port.
            DeviceBusyError: Somebody else holds it.
            DeviceError: It may not be opened (`port-forbidden`), or is no serial port.
        """
        self.settings = settings
        self.device = settings.device
        self.received = bytearray()
        self._sent = b""
        self._closed = False
        self._serial: serial.Serial | None = self._open()

    @property
    def last_exchange(self) -> str:
        """The last bytes sent and received, for reports."""
        received = bytes(self.received[-_SHOWN_BYTES:])
        return f"sent {self._sent[-_SHOWN_BYTES:]!r}, received {received!r}"

    def ensure_open(self) -> bool:
        """Open a lost port again, once; return whether that was needed.

        Raises DeviceLostError when it is still gone, or was closed for good.
        """
        if self._closed:
            raise self._lost("the port was closed by this program", code="device-closed")
        if self._serial is not None:
            return False
        try:
            self._serial = self._open()
        except DeviceNotFoundError as error:
            raise self._lost("still gone; plug it in again") from error
        return True

    def write(self, data: bytes) -> None:
        """Send all of `data`; DeviceTimeoutError when nobody takes it."""
        self._sent = data
        with self._failures_named():
            self._open_port().write(data)

    def read_some(self) -> bytes:
        """Return what arrived, at most 20 ms from now; empty where nothing did."""
        with self._failures_named():
            port = self._open_port()
            data: bytes = port.read(1)
            if data:
                data += port.read(port.in_waiting)
        self.received += data
        return data

    def has_input(self) -> bool:
        """Return whether something arrived that nobody has read."""
        with self._failures_named():
            return bool(self._open_port().in_waiting)

    def discard_input(self) -> None:
        """Throw away what arrived before the next question."""
        self.received.clear()
        with self._failures_named():
            self._open_port().reset_input_buffer()

    def close(self) -> None:
        """Let go for good; safe to call twice."""
        self._closed = True
        self._drop()

    def _open(self) -> serial.Serial:
        try:
            return serial.Serial(
                self.settings.address,
                self.settings.baudrate,
                timeout=_POLL_S,
                write_timeout=self.settings.write_timeout_s,
                exclusive=True,
            )
        except _LINE_FAILURES as error:
            raise self._not_opened(error) from error

    def _not_opened(self, error: Exception) -> DeviceError:
        number = getattr(error, "errno", None) or (error.args[0] if error.args else None)
        kind, code, text = _REFUSALS.get(
            number, (DeviceError, "device-failed", f"cannot be opened ({error})")
        )
        return kind(f"{self.device}: {text}", device=self.device, code=code)

    def _open_port(self) -> serial.Serial:
        if self._serial is None:
            raise self._lost("gone; plug it in again")
        return self._serial

    @contextmanager
    def _failures_named(self) -> Iterator[None]:
        try:
            yield
        except serial.SerialTimeoutException as error:
            with suppress(*_LINE_FAILURES):
                self._open_port().reset_output_buffer()
            raise DeviceTimeoutError(
                f"{self.device}: does not take what is sent to it; is it switched on?",
                device=self.device,
                code="device-timeout",
                last_exchange=self.last_exchange,
            ) from error
        except _LINE_FAILURES as error:
            self._drop()
            raise self._lost("gone in the middle of an exchange; plug it in again") from error

    def _drop(self) -> None:
        port, self._serial = self._serial, None
        if port is not None:
            with suppress(*_LINE_FAILURES):
                port.close()

    def _lost(self, text: str, *, code: str = "device-lost") -> DeviceLostError:
        return DeviceLostError(
            f"{self.device}: {text}",
            device=self.device,
            code=code,
            last_exchange=self.last_exchange,
        )
