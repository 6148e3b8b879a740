"""One LED on a Mightex SLC or BLS controller, at continuous current.

The level is the current relative to the nominal one: with a nominal current of 1 mA it is in mA.
"""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from threading import Lock

from drivers.errors import DeviceError, SettingRefusedError
from drivers.ports import Cancelled, DeviceIdentity, LampState, LightState, never
from drivers.serial.levels import level_within
from drivers.serial.link import SerialLink
from drivers.serial.mightex_channel import SYNC, MightexChannel
from drivers.serial.off_after import off_after
from drivers.serial.port import PortSettings


class MightexLed:
    """One channel as a light source. `off` may be called at any moment."""

    def __init__(
        self, channel: MightexChannel, *, nominal_current_ma: float, max_current_ma: float
    ) -> None:
        """Prefer `open`."""
        self._channel = channel
        self._link = channel.link
        self._nominal_ma = nominal_current_ma
        self._max_ma = max_current_ma
        self._setting = Lock()
        self._off_orders = 0

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
        link = SerialLink(settings, end="\n\r", timeout_s=timeout_s, sync=SYNC)
        try:
            return cls(
                MightexChannel(link, channel),
                nominal_current_ma=nominal_current_ma,
                max_current_ma=max_current_ma,
            )
        except BaseException:
            link.close()
            raise

    @property
    def identity(self) -> DeviceIdentity:
        """The controller's."""
        return self._channel.identity

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
        resolution_ma = self._channel.resolution_ma
        current_ma = round(level * self._nominal_ma / resolution_ma) * resolution_ma
        with self._setting:
            order = self._off_orders
            try:
                for step in self._steps(current_ma):
                    if cancelled():
                        return self.state()
                    with self._link.lock:
                        self._still_ordered(order)
                        step()
                return self._verified(current_ma, order)
            except DeviceError as error:
                if error.code != "switched-off":
                    off_after(error, self.off)
                raise

    def state(self) -> LightState:
        """Read the channel back; the voltage is None while it is off."""
        with self._link.lock:
            current_ma = self._channel.current_ma()
            voltage_v = self._channel.voltage_v() if current_ma > 0 else None
        lamp = LampState(on=current_ma > 0, current_a=current_ma / 1000, voltage_v=voltage_v)
        return LightState(level=current_ma / self._nominal_ma, lamps=(lamp,))

    def order_off(self) -> None:
        """Disable the channel."""
        self._off_orders += 1
        with suppress(DeviceError), self._link.lock:  # it is sent again, and read back
            self._channel.switch(on=False)

    def off(self) -> LightState:
        """Disable the channel and read it back.

        Raises DeviceError with code `lamps-not-off` when it is not known to be off; where the line
        is at fault the error is of the line's class.
        """
        self._off_orders += 1
        with self._link.lock:
            try:
                self._channel.switch(on=False)
                state = self.state()
            except DeviceError as error:
                raise self._not_off(str(error), type(error)) from error
        if state.lamps[0].on:
            raise self._not_off("it reads back as on", DeviceError)
        return state

    def close(self) -> None:
        """Release the line; the LED stays as it is. Safe to call twice."""
        self._link.close()

    def _steps(self, current_ma: float) -> tuple[Callable[[], None], ...]:
        if not current_ma:
            return (partial(self._channel.switch, on=False),)
        return (
            partial(self._channel.set_current, current_ma, self._max_ma),
            partial(self._channel.switch, on=True),
        )

    def _verified(self, current_ma: float, order: int) -> LightState:
        with self._link.lock:
            state = self.state()
            self._still_ordered(order)
        read_back_ma = state.lamps[0].current_a * 1000
        if abs(read_back_ma - current_ma) > self._channel.resolution_ma / 2:
            raise SettingRefusedError(
                f"{self._link.device}: the LED reads back {read_back_ma:g} mA, "
                f"not {current_ma:g} mA",
                device=self._link.device,
                code="lamp-current",
                last_exchange=self._link.port.last_exchange,
            )
        return state

    def _still_ordered(self, order: int) -> None:
        if self._off_orders != order:
            raise DeviceError(
                f"{self._link.device}: switched off while it was being set",
                device=self._link.device,
                code="switched-off",
            )

    def _not_off(self, why: str, kind: type[DeviceError]) -> DeviceError:
        return kind(
            f"{self._link.device}: the LED is not known to be off; switch the controller off by "
            f"hand ({why})",
            device=self._link.device,
            code="lamps-not-off",
            last_exchange=self._link.port.last_exchange,
        )
