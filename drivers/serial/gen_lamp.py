"""One lamp on one GEN supply: how it is ramped, and what is wrong with how it burns."""

from collections.abc import Callable
from dataclasses import dataclass

from drivers.errors import DeviceError, SettingRefusedError
from drivers.serial.gen_units import GenUnits, Unit, UnitReading


@dataclass(frozen=True)
class LampRating:
    """How the lamps are to be burnt.

    Attributes:
        nominal_current_a: At which they are calibrated.
        voltage_limit_v: Above a warm lamp's voltage; a lamp that needs more has aged or broken.
        ramp_step_a, ramp_step_s: A cold filament's resistance is a small part of the hot one's;
            tungsten lamps are therefore ramped, by this much every so long.
        tolerance_a: How far from nominal the current may be read back.
        settle_s: How long after the ramp it may take to get there.
    """

    nominal_current_a: float
    voltage_limit_v: float
    ramp_step_a: float = 0.5
    ramp_step_s: float = 0.1
    tolerance_a: float = 0.02
    settle_s: float = 1.0


class GenLamp:
    """Ramps one lamp, and judges how it burns."""

    def __init__(self, units: GenUnits, unit: Unit, rating: LampRating) -> None:
        self._units = units
        self._rating = rating
        self.unit = unit

    @property
    def name(self) -> str:
        """Which lamp, and where its supply is."""
        return self._units.name(self.unit)

    def read(self) -> UnitReading:
        """Read the supply back."""
        return self._units.read(self.unit)

    def burns(self, reading: UnitReading) -> bool:
        """Whether the lamp burns at its nominal current, regulated."""
        off_by_a = abs(reading.current_a - self._rating.nominal_current_a)
        regulated = reading.output_on and reading.mode == "CC"
        return regulated and off_by_a <= self._rating.tolerance_a

    def ramp(self, *, burn: bool, step: Callable[[Callable[[], None]], bool]) -> bool:
        """Go to the nominal current, or to none and switch off; return whether it got there.

        `step(command)` does one command of the ramp, and returns whether to go on.
        """
        now_a = self._programmed_a()
        if now_a is None:
            if not burn:
                return True
            now_a = 0.0
            if not (
                step(self._limit)
                and step(self._teller("PC 0.000"))
                and step(self._teller("OUT ON"))
            ):
                return False
        elif burn and self._has_another_limit() and not step(self._limit):
            return False
        for current_a in self._steps(now_a, self._rating.nominal_current_a if burn else 0.0):
            if not step(self._teller(f"PC {current_a:.3f}")):
                return False
        return burn or step(self._teller("OUT OFF"))

    def switch_off(self) -> None:
        """Switch this supply's output off, without a ramp."""
        self._units.tell(self.unit, "OUT OFF")

    def problem(self, reading: UnitReading, *, should_burn: bool) -> DeviceError | None:
        """Return what is wrong with `reading`, None where nothing is."""
        if not should_burn:
            return self._refused("is still on", "lamp-not-off") if reading.output_on else None
        if reading.faults:
            why = ", ".join(reading.faults)
            return self._failed(f"its supply reports: {why}", "lamp-fault")
        if not reading.output_on:
            return self._refused("is off although it was switched on", "lamp-dark")
        return None if self.burns(reading) else self._not_nominal(reading)

    def _not_nominal(self, reading: UnitReading) -> DeviceError:
        if reading.mode != "CC":
            return self._refused(
                f"is not at constant current ({reading.mode}, {reading.voltage_v:g} V): broken, "
                "aged, or the voltage limit is too low",
                "lamp-not-in-current-mode",
            )
        wanted = f"{self._rating.nominal_current_a:g} ± {self._rating.tolerance_a:g} A"
        return self._refused(f"burns at {reading.current_a:g} A, not {wanted}", "lamp-current")

    def _programmed_a(self) -> float | None:
        """The current that the supply is set to, None where its output is off."""
        if not self._units.output_on(self.unit):
            return None
        return self._units.number(self.unit, "PC?")

    def _has_another_limit(self) -> bool:
        """Whether other software left another voltage limit on a supply that is on."""
        return abs(self._units.number(self.unit, "PV?") - self._rating.voltage_limit_v) > 1e-3

    def _limit(self) -> None:
        self._units.tell(self.unit, f"PV {self._rating.voltage_limit_v:.3f}")

    def _steps(self, from_a: float, to_a: float) -> list[float]:
        step_a = self._rating.ramp_step_a
        sign = 1.0 if to_a > from_a else -1.0
        n_whole = int((abs(to_a - from_a) - 1e-6) // step_a) if to_a != from_a else 0
        between = [from_a + sign * step_a * (i + 1) for i in range(n_whole)]
        return [*between, to_a] if to_a != from_a else []

    def _teller(self, command: str) -> Callable[[], None]:
        return lambda: self._units.tell(self.unit, command)

    def _refused(self, text: str, code: str) -> SettingRefusedError:
        return SettingRefusedError(f"{self.name} {text}", device=self._units.link.device, code=code)

    def _failed(self, text: str, code: str) -> DeviceError:
        return DeviceError(f"{self.name}: {text}", device=self._units.link.device, code=code)
