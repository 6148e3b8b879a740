"""A shutter on one relay of a Devantech USB-RLY16.

Nothing acknowledges a command, so every one is read back. Source: USB-RLY16 technical
documentation, "Commands".
"""

import re
import time

from drivers.errors import SettingRefusedError
from drivers.ports import DeviceIdentity
from drivers.serial.link import SerialLink
from drivers.serial.port import PortSettings
from drivers.serial.sync import Sync

_VERSION, _STATES = b"\x5a", b"\x5b"
_ALL_ON, _ALL_OFF = 0x64, 0x6E  # plus n: relay n alone, 1 ... 8
_MODULE_ID = 9
_SYNC = Sync(question=_VERSION, answer=re.compile(rb"\x09.", re.DOTALL))


class RelayShutter:
    """Caps the camera by one relay."""

    def __init__(
        self, link: SerialLink, *, relay: int, capped_when_on: bool, travel_s: float
    ) -> None:
        """Prefer `open`."""
        self._link = link
        self._relay = relay
        self._capped_when_on = capped_when_on
        self._travel_s = travel_s
        module, version = link.query_bytes(_VERSION, 2)
        if module != _MODULE_ID:
            raise link.protocol_error(f"module {module} is no USB-RLY16, which is module 9")
        self._identity = DeviceIdentity(
            "Devantech", "USB-RLY16", "", str(version), link.port.settings.address
        )

    @classmethod
    def open(
        cls,
        port: str,
        *,
        relay: int = 1,
        capped_when_on: bool = True,
        travel_s: float = 0.3,
        baudrate: int = 9600,
        timeout_s: float = 0.5,
        name: str = "shutter",
    ) -> "RelayShutter":
        """Find the relay board; leave the shutter where it is.

        Args:
            port: The port's path.
            relay: 1 ... 8.
            capped_when_on: Whether the powered relay closes the shutter.
            travel_s: How long the shutter takes to move; nothing reports that it has arrived.
            baudrate: The board's USB port takes any.
            timeout_s: How long a reply may take.
            name: What the bench file calls it.

        Raises DeviceNotFoundError, DeviceBusyError, DeviceTimeoutError or ProtocolError.
        """
        if not 1 <= relay <= 8:
            raise SettingRefusedError(
                f"{name} at {port}: there is no relay {relay}; use 1 ... 8",
                device=f"{name} at {port}",
                code="setting-refused",
            )
        settings = PortSettings(port, name, baudrate)
        link = SerialLink(settings, end="", timeout_s=timeout_s, sync=_SYNC)
        try:
            return cls(link, relay=relay, capped_when_on=capped_when_on, travel_s=travel_s)
        except BaseException:
            link.close()
            raise

    @property
    def identity(self) -> DeviceIdentity:
        """The relay board's; it has no serial number."""
        return self._identity

    def set_capped(self, capped: bool) -> None:
        """Switch the relay, read it back, and wait until the shutter has moved.

        Raises SettingRefusedError with code `shutter-stuck` when it reads back otherwise.
        """
        on = capped == self._capped_when_on
        with self._link.lock:
            self._link.ready()
            self._link.send_bytes(bytes([(_ALL_ON if on else _ALL_OFF) + self._relay]))
            states = self._link.query_bytes(_STATES, 1)[0]
        if bool(states >> (self._relay - 1) & 1) != on:
            raise SettingRefusedError(
                f"{self._link.device}: relay {self._relay} reads back "
                f"{'off' if on else 'on'} although it was switched {'on' if on else 'off'}",
                device=self._link.device,
                code="shutter-stuck",
                last_exchange=self._link.port.last_exchange,
            )
        time.sleep(self._travel_s)

    def close(self) -> None:
        """Release the line; safe to call twice."""
        self._link.close()
