"""The Mightex SLC and BLS protocol: one channel's commands and queries.

Source: Mightex, Sirius SLC LED Driver command set (RS232): 9600 baud, commands end LF CR.
"""

import re

from drivers.errors import SettingRefusedError
from drivers.ports import DeviceIdentity
from drivers.serial.link import SerialLink
from drivers.serial.sync import Sync

SYNC = Sync(
    question=b"DEVICEINFO\n\r",
    answer=re.compile(rb"(?<![^\r\n])Mightex[^\r\n]+(?=[\r\n])"),
    clear=b"\n\rECHOOFF\n\r",
)
_IDENTITY = re.compile(
    r"Mightex LED Driver:(?P<firmware>\S+) Device Module No\.:(?P<model>\S+) "
    r"Device Serial No\.:(?P<serial>\S+)"
)
_TENTHS_OF_MA = re.compile(r"-(FA|FV|XA|XV)")
_DISABLED, _NORMAL = 0, 1


class MightexChannel:
    """Hold `link.lock` around exchanges that belong together. Currents are in mA.

    Attributes:
        identity: The controller's.
        resolution_ma: The smallest step of its current.
    """

    def __init__(self, link: SerialLink, channel: int) -> None:
        """Ask the controller who it is; ProtocolError where it is no Mightex."""
        self.link = link
        self._channel = channel
        reply = link.query("DEVICEINFO")
        match = _IDENTITY.match(reply)
        if match is None:
            raise link.protocol_error(f"{reply!r} is not how a Mightex controller names itself")
        self.identity = DeviceIdentity(
            "Mightex",
            match["model"],
            match["serial"],
            match["firmware"],
            link.port.settings.address,
        )
        self.resolution_ma = 0.1 if _TENTHS_OF_MA.search(match["model"]) else 1.0

    def set_current(self, current_ma: float, ceiling_ma: float) -> None:
        """Set the current of the normal mode; it flows once that is switched on."""
        ceiling, current = (round(ma / self.resolution_ma) for ma in (ceiling_ma, current_ma))
        self._tell(f"NORMAL {self._channel} {ceiling} {current}")

    def switch(self, *, on: bool) -> None:
        """Switch to normal mode, or disable the channel."""
        self._tell(f"MODE {self._channel} {_NORMAL if on else _DISABLED}")

    def current_ma(self) -> float:
        """The current that flows as the controller is set, 0 where the channel is disabled."""
        if self._number("?MODE", r"#(\d)") != _NORMAL:
            return 0.0
        # Calibration values come first, then the ceiling; the last number is the current.
        return self._number("?CURRENT", r"#[\d ]*\b(\d+)\s*") * self.resolution_ma

    def voltage_v(self) -> float:
        """The LED's voltage."""
        return self._number("LoadVoltage", rf"#{self._channel}:(\d+)") / 1000.0

    def _tell(self, command: str) -> None:
        if (reply := self.link.query(command)) == "##":
            return
        if reply in ("#!", "#?") or reply.endswith("is not defined"):
            raise SettingRefusedError(
                f"{self.link.device} refuses {command!r} ({reply})",
                device=self.link.device,
                code="setting-refused",
                last_exchange=self.link.port.last_exchange,
            )
        raise self.link.protocol_error(f"{reply!r} instead of ## to {command!r}")

    def _number(self, query: str, pattern: str) -> int:
        reply = self.link.query(f"{query} {self._channel}")
        match = re.fullmatch(pattern, reply)
        if match is None:
            raise self.link.protocol_error(f"{reply!r} in answer to {query!r}")
        return int(match[1])
