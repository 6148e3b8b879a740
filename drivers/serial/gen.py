"""A sphere with lamps, one current-regulated GEN power supply for each; level n burns n lamps."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Event, Lock
from time import monotonic

from drivers.errors import DeviceError
from drivers.ports import Cancelled, DeviceIdentity, LampState, LightState, never
from drivers.serial.gen_lamp import GenLamp, LampRating
from drivers.serial.gen_off import read_back_off
from drivers.serial.gen_units import GenUnits, UnitReading
from drivers.serial.lamp_hours import LampHours
from drivers.serial.levels import whole_level
from drivers.serial.link import SerialLink
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
        self._off_orders = 0  # a ramp that finds it changed stops
        self._ordered_off = Event()

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
    ) -> "GenLamps":
        """Find the supply of each lamp, lamp 1 first; leave their outputs as they are.

        Raises:
            DeviceNotFoundError: No such port, or a supply that does not answer.
            DeviceBusyError: Somebody else holds the port.
            InputError: The file at `hours_path` cannot be read.
        """
        hours = LampHours(hours_path, range(1, len(addresses) + 1))
        link = SerialLink(PortSettings(port, name, baudrate), end="\r", timeout_s=timeout_s)
        try:
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
        return DeviceIdentity(
            vendor, model, unit.serial, address=self._units.link.port.settings.address
        )

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
            with self._units.link.lock:
                order = self._off_orders
                self._ordered_off.clear()
            try:
                for lamp in self._lamps:
                    if not lamp.ramp(
                        burn=lamp.unit.lamp <= burning, step=self._step(order, cancelled)
                    ):
                        return self.state()
                return self._settled(burning, order)
            except DeviceError as error:
                if error.code != "switched-off":
                    self._off_after(error)
                raise

    def state(self) -> LightState:
        """Read every lamp back; `level` is the number that burn at their nominal current."""
        return self._state([lamp.read() for lamp in self._lamps])

    def order_off(self) -> None:
        """Send the group command, whoever uses the line."""
        self._off_orders += 1
        self._ordered_off.set()
        with suppress(DeviceError):  # it is sent again, with the lock held, and read back
            self._units.link.interject("GOUT OFF")

    def off(self) -> LightState:
        """Switch all supplies off by the group command at once, and read each one back.

        Raises DeviceError with code `lamps-not-off`, naming every lamp that is not known to be off;
        of the line's class (DeviceLostError, ...) where that alone is at fault.
        """
        self.order_off()
        return self._state(read_back_off(self._units, self._lamps))

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
                self._still_ordered(order)
                command()
            self._ordered_off.wait(self._rating.ramp_step_s)
            return True

        return step

    def _still_ordered(self, order: int) -> None:
        if self._off_orders != order:
            device = self._units.link.device
            raise DeviceError(
                f"{device}: switched off while the lamps were being set",
                device=device,
                code="switched-off",
            )

    def _settled(self, burning: int, order: int) -> LightState:
        """Read back until every lamp burns as it should, or raise what is wrong with the first."""
        deadline = monotonic() + self._rating.settle_s
        while True:
            readings = [lamp.read() for lamp in self._lamps]
            self._still_ordered(order)
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
            self._ordered_off.wait(_SETTLE_POLL_S)

    def _off_after(self, error: DeviceError) -> None:
        """Leave nothing lit behind `error`; note on it what could not be read back as off."""
        try:
            self.off()
        except DeviceError as second:
            error.add_note(str(second))

    def _state(self, readings: Sequence[UnitReading]) -> LightState:
        """Count the hours, and say what burns."""
        lamps = []
        for lamp, reading in zip(self._lamps, readings, strict=True):
            self._hours.seen(lamp.unit.lamp, burning=reading.output_on)
            lamps.append(
                LampState(
                    on=reading.output_on,
                    current_a=reading.current_a,
                    voltage_v=reading.voltage_v,
                    hours=self._hours.hours(lamp.unit.lamp),
                )
            )
        level = sum(map(GenLamp.burns, self._lamps, readings))
        return LightState(level=float(level), lamps=tuple(lamps))
