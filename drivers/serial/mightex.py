"""One LED on a Mightex SLC or BLS controller, at continuous current.

The level is the current relative to the nominal one: with a nominal current of 1 mA it is in mA.
"""

import re
from threading import Lock

from drivers.errors import DeviceError, SettingRefusedError
from drivers.ports import Cancelled, DeviceIdentity, LampState, LightState, never
from drivers.serial.levels import level_within
from drivers.serial.link import SerialLink, Sync
from drivers.serial.port import PortSettings

_IDENTITY = re.compile(
    r"Mightex LED Driver:(?P<firmware>\S+) Device Module No\.:(?P<model>\S+) "
    r"Device Serial No\.:(?P<serial>\S+)"
)
_SYNC = Sync(
    question=b"DEVICEINFO\n\r",
    answer=re.compile(rb"(?<![^\r\n])Mightex[^\r\n]+(?=[\r\n])"),
    clear=b"\n\rECHOOFF\n\r",
)
_TENTHS_OF_MA = re.compile(r"-(FA|FV|XA|XV)")
_DISABLED, _NORMAL = "0", "1"


class MightexLed:
    """One channel as a light source. `off` may be called at any moment."""

    def __init__(
        self, link: SerialLink, *, channel: int, nominal_current_ma: float, max_current_ma: float
    ) -> None:
        """Prefer `open`."""
        self._link = link
        self._channel = channel
        self._nominal_ma = nominal_current_ma
        self._max_ma = max_current_ma
        self._setting = Lock()
        self._off_orders = 0
        reply = link.query("DEVICEINFO")
        match = _IDENTITY.match(reply)
        if match is None:
            raise link.protocol_error(f"{reply!r} is not how a Mightex controller names itself")
        self._identity = DeviceIdentity(
            "Mightex",
            match["model"],
            match["serial"],
            match["firmware"],
            link.port.settings.address,
        )
        self._per_ma = 10.0 if _TENTHS_OF_MA.search(match["model"]) else 1.0

    @classmethod
    def open(
        cls,
        port: str,
        *,
        channel: int = 1,
        nominal_current_ma: float = 500.0,
        max_current_ma: float = 1000.0,
        baudrate: int = 9600,
        timeout_s: float = 0.4,
        name: str = "led",
    ) -> "MightexLed":
        """Find the controller and silence its echo; leave the channel as it is.

        Raises DeviceNotFoundError, DeviceBusyError, DeviceTimeoutError or ProtocolError.
        """
        settings = PortSettings(port, name, baudrate)
        link = SerialLink(settings, end="\n\r", timeout_s=timeout_s, sync=_SYNC)
        try:
            return cls(
                link,
                channel=channel,
                nominal_current_ma=nominal_current_ma,
                max_current_ma=max_current_ma,
            )
        except BaseException:
            link.close()
            raise

    @property
    def identity(self) -> DeviceIdentity:
        """The controller's."""
        return self._identity

    @property
    def max_level(self) -> float:
        """The highest current relative to the nominal one."""
        return self._max_ma / self._nominal_ma

    def set_level(self, level: float, cancelled: Cancelled = never) -> LightState:
        """Drive the LED at `level` times its nominal current, to the controller's resolution.

        Where it fails, the LED is switched off before the error is raised.

        Raises:
            SettingRefusedError: `level-out-of-range`, or it reads back otherwise than it was set.
            DeviceError: `switched-off` when `off` came between.
        """
        level_within(level, self.max_level, self._link.device)
        current = round(level * self._nominal_ma * self._per_ma)
        ceiling = round(self._max_ma * self._per_ma)
        with self._setting:
            order = self._off_orders
            commands = [f"MODE {self._channel} {_DISABLED}"]
            if current:
                commands = [
                    f"NORMAL {self._channel} {ceiling} {current}",
                    f"MODE {self._channel} {_NORMAL}",
                ]
            try:
                for command in commands:
                    if cancelled():
                        return self.state()
                    with self._link.lock:
                        self._still_ordered(order)
                        self._tell(command)
                return self._verified(current, order)
            except DeviceError as error:
                if error.code != "switched-off":
                    self._off_after(error)
                raise

    def state(self) -> LightState:
        """Read the channel back; the voltage is None while it is off."""
        with self._link.lock:
            mode = self._number("?MODE", r"#(\d)")
            current = self._number("?CURRENT", r"#[\d ]*?(\d+)\s*")
            on = str(mode) == _NORMAL and current > 0
            voltage_v = (
                self._number("LoadVoltage", rf"#{self._channel}:(\d+)") / 1000 if on else None
            )
        current_ma = current / self._per_ma if on else 0.0
        lamp = LampState(on=on, current_a=current_ma / 1000, voltage_v=voltage_v)
        return LightState(level=current_ma / self._nominal_ma, lamps=(lamp,))

    def off(self) -> LightState:
        """Disable the channel and read it back.

        Raises DeviceError with code `lamps-not-off` when it is not known to be off; where the line
        is at fault the error is of the line's class.
        """
        self._off_orders += 1
        with self._link.lock:
            try:
                self._tell(f"MODE {self._channel} {_DISABLED}")
                state = self.state()
            except DeviceError as error:
                raise self._not_off(str(error), type(error), error.last_exchange) from error
        if state.lamps[0].on:
            raise self._not_off("it reads back as on", DeviceError, self._link.port.last_exchange)
        return state

    def close(self) -> None:
        """Release the line; the LED stays as it is. Safe to call twice."""
        self._link.close()

    def _verified(self, current: int, order: int) -> LightState:
        with self._link.lock:
            state = self.state()
            self._still_ordered(order)
        read_back = round(state.lamps[0].current_a * 1000 * self._per_ma)
        if read_back != current:
            raise SettingRefusedError(
                f"{self._link.device}: channel {self._channel} reads back "
                f"{read_back / self._per_ma:g} mA, not {current / self._per_ma:g} mA",
                device=self._link.device,
                code="lamp-current",
                last_exchange=self._link.port.last_exchange,
            )
        return state

    def _tell(self, command: str) -> None:
        if (reply := self._link.query(command)) == "##":
            return
        if reply in ("#!", "#?") or reply.endswith("is not defined"):
            raise SettingRefusedError(
                f"{self._link.device} refuses {command!r} ({reply})",
                device=self._link.device,
                code="setting-refused",
                last_exchange=self._link.port.last_exchange,
            )
        raise self._link.protocol_error(f"{reply!r} instead of ## to {command!r}")

    def _number(self, query: str, pattern: str) -> int:
        reply = self._link.query(f"{query} {self._channel}")
        match = re.fullmatch(pattern, reply)
        if match is None:
            raise self._link.protocol_error(f"{reply!r} in answer to {query!r}")
        return int(match[1])

    def _still_ordered(self, order: int) -> None:
        if self._off_orders != order:
            raise DeviceError(
                f"{self._link.device}: switched off while it was being set",
                device=self._link.device,
                code="switched-off",
            )

    def _off_after(self, error: DeviceError) -> None:
        """Leave nothing lit behind `error`; note on it when that did not work."""
        try:
            self.off()
        except DeviceError as second:
            error.add_note(str(second))

    def _not_off(self, why: str, kind: type[DeviceError], last_exchange: str) -> DeviceError:
        return kind(
            f"{self._link.device}: channel {self._channel} is not known to be off; switch the "
            f"controller off by hand ({why})",
            device=self._link.device,
            code="lamps-not-off",
            last_exchange=last_exchange,
        )
