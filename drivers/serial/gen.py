"""A sphere with lamps, one current-regulated GEN power supply for each; level n burns n lamps."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Lock
from time import monotonic

from drivers.errors import DeviceError
from drivers.ports import Cancelled, DeviceIdentity, LampState, LightState, never
from drivers.serial.gen_lamp import GenLamp, LampRating
from drivers.serial.gen_off import OffReadBack
from drivers.serial.gen_orders import OffOrders
from drivers.serial.gen_units import GenUnits, UnitReading
from drivers.serial.lamp_hours import LampHours
from drivers.serial.levels import whole_level
from drivers.serial.link import SerialLink
from drivers.serial.off_after import off_after
from drivers.serial.port import PortSettings

_SETTLE_POLL_S = 0.05


class GenLamps:
    """N lamps. `off` may be called at any moment, also while another thread ramps."""

    def __init__(
        self, units: GenUnits, lamps: Sequence[GenLamp], rating: LampRating, hours: LampHours
    ) -> None:
        """Prefer `open`."""
        self._units = units
        self._lamps = tuple(lamps)
        self._rating = rating
        self._hours = hours
        self._ramping = Lock()
        self._orders = OffOrders(units.link)
        self._off = OffReadBack(units, self._lamps)

    @classmethod
    def open(
        cls,
        port: str,
        *,
        addresses: Sequence[int],
        rating: LampRating,
        hours_path: Path | None = None,
        baudrate: int = 9600,
        timeout_s: float = 1.0,
        address_settle_s: float = 0.1,
        name: str = "lamps",
        dark: bool = False,
    ) -> "GenLamps":
        """Find the supply of each lamp, lamp 1 first; leave their outputs as they are.

        Where `dark`, all are told to go off first: to find each takes time, and may fail.

        Raises:
            DeviceNotFoundError: No such port, or a supply that does not answer.
            DeviceBusyError: Somebody else holds the port.
            InputError: The file at `hours_path` cannot be read.
        """
        hours = LampHours(hours_path, range(1, len(addresses) + 1))
        link = SerialLink(PortSettings(port, name, baudrate), end="\r", timeout_s=timeout_s)
        try:
            if dark:
                link.interject("\rGOUT OFF")  # first the end of what a dead program left half sent
            units = GenUnits(link, address_settle_s=address_settle_s)
            found = [units.find(lamp, address) for lamp, address in enumerate(addresses, start=1)]
            for unit in found:
                units.tell(unit, "RMT REM")
        except BaseException:
            link.close()
            raise
        return cls(units, [GenLamp(units, unit, rating) for unit in found], rating, hours)

    @property
    def identity(self) -> DeviceIdentity:
        """Of the first supply."""
        unit = self._lamps[0].unit
        vendor, _, model = unit.model.partition(",")
        address = self._units.link.port.settings.address
        return DeviceIdentity(vendor, model, unit.serial, address=address)

    @property
    def max_level(self) -> float:
        """The number of lamps."""
        return float(len(self._lamps))

    def set_level(self, level: float, cancelled: Cancelled = never) -> LightState:
        """Burn the first `level` lamps at their nominal current, and the others not at all.

        When a lamp does not burn as it should, all are switched off before the error is raised.
        Where `cancelled` ends it early, the state is what was reached.

        Raises:
            SettingRefusedError: `level-out-of-range`; `lamp-dark`, `lamp-current`, `lamp-not-off`
                or `lamp-not-in-current-mode` when a lamp reads back otherwise than it was set.
            DeviceError: `lamp-fault` with the supply's own reason; `switched-off` when `off` came
                between. What the line may do to it: see SerialLink.
        """
        burning = whole_level(level, len(self._lamps), self._units.link.device)
        with self._ramping:
            order = self._orders.begin()
            try:
                for lamp in self._lamps:
                    burn = lamp.unit.lamp <= burning
                    if not lamp.ramp(burn=burn, step=self._step(order, cancelled)):
                        return self._state(self._read(order))
                return self._settled(burning, order)
            except DeviceError as error:
                if error.code != "switched-off":
                    off_after(error, self.off)
                raise

    def state(self) -> LightState:
        """Read every lamp back; `level` is the number that burn at their nominal current.

        Raises DeviceError `switched-off` when `off` came between: it does not wait for the rest.
        """
        return self._state(self._read(self._orders.count))

    def order_off(self) -> None:
        """Send the group command, whoever uses the line."""
        self._orders.give()

    def off(self) -> LightState:
        """Switch all supplies off by the group command at once, and read each one back.

        Raises DeviceError with code `lamps-not-off`, naming every lamp that is not known to be off;
        of the line's class (DeviceLostError, ...) where that alone is at fault.
        """
        self.order_off()
        return self._state(self._off.readings())

    def close(self) -> None:
        """Release the line; the lamps stay as they are. Safe to call twice."""
        self._units.link.close()
        self._hours.save()

    def _step(self, order: int, cancelled: Cancelled) -> Callable[[Callable[[], None]], bool]:
        """Return what does one command of a ramp, unless it is to end."""

        def step(command: Callable[[], None]) -> bool:
            if cancelled():
                return False
            with self._units.link.lock:
                self._orders.check(order)
                self._off.forget()
                command()
            self._orders.wait(self._rating.ramp_step_s)
            return True

        return step

    def _read(self, order: int) -> list[UnitReading]:
        readings: list[UnitReading] = []
        for lamp in self._lamps:
            self._orders.check(order)
            readings.append(lamp.read())
        self._orders.check(order)
        return readings

    def _settled(self, burning: int, order: int) -> LightState:
        """Read back until every lamp burns as it should, or raise what is wrong with the first."""
        deadline = monotonic() + self._rating.settle_s
        while True:
            readings = self._read(order)
            problems = [
                problem
                for lamp, reading in zip(self._lamps, readings, strict=True)
                if (problem := lamp.problem(reading, should_burn=lamp.unit.lamp <= burning))
            ]
            if not problems:
                return self._state(readings)
            if monotonic() > deadline:
                self._state(readings)
                raise problems[0]
            self._orders.wait(_SETTLE_POLL_S)

    def _state(self, readings: Sequence[UnitReading]) -> LightState:
        """Count the hours, and say what burns."""
        pairs = tuple(zip(self._lamps, readings, strict=True))
        self._hours.seen({lamp.unit.lamp: reading.output_on for lamp, reading in pairs})
        lamps = [
            LampState(
                on=reading.output_on,
                current_a=reading.current_a,
                voltage_v=reading.voltage_v,
                hours=self._hours.hours(lamp.unit.lamp),
            )
            for lamp, reading in pairs
        ]
        level = sum(map(GenLamp.burns, self._lamps, readings))
        return LightState(level=float(level), lamps=tuple(lamps))
