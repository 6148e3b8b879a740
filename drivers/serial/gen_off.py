"""Switching every supply off, and knowing of each lamp whether it is."""

from collections.abc import Sequence
from contextlib import suppress
from time import monotonic

from drivers.errors import DeviceError
from drivers.serial.gen_lamp import GenLamp
from drivers.serial.gen_units import GenUnits, UnitReading


class OffReadBack:
    """Reads back for everybody who switches off at the same time. Thread-safe.

    Six supplies on a slow line take two seconds: who comes meanwhile is given what is being read,
    rather than to wait for that and then as long again.
    """

    def __init__(self, units: GenUnits, lamps: Sequence[GenLamp]) -> None:
        self._units = units
        self._lamps = tuple(lamps)
        self._readings: list[UnitReading] = []
        self._read_at_s: float | None = None

    def readings(self) -> list[UnitReading]:
        """Return what every supply reads back, each off; see `read_back_off`."""
        asked_at_s = monotonic()
        with self._units.link.lock:
            if self._read_at_s is None or self._read_at_s < asked_at_s:
                self._read_at_s = None
                self._readings = read_back_off(self._units, self._lamps)
                self._read_at_s = monotonic()
            return self._readings

    def forget(self) -> None:
        """Something is about to be told to a supply, with the line's lock held."""
        self._read_at_s = None


def read_back_off(units: GenUnits, lamps: Sequence[GenLamp]) -> list[UnitReading]:
    """Send the group command, then read each supply back; one that is still on is told alone.

    Where some supplies answer, one that does not is asked once more: a reply that got lost must
    not send somebody to the bench. Where none does, the line is dead, and asking again only
    delays the alarm.

    Raises DeviceError with code `lamps-not-off` after every lamp was tried, naming those that are
    not known to be off; of the line's class where that alone is at fault.
    """
    readings: dict[GenLamp, UnitReading] = {}
    failures: dict[GenLamp, DeviceError] = {}
    with units.link.lock:
        with suppress(DeviceError):  # what is wrong shows when each lamp is read back
            units.all_off()
        _try(lamps, readings, failures)
        if failures and (readings or len(lamps) == 1):
            _try(tuple(failures), readings, failures)
    if failures:
        raise _not_off(units.link.device, failures)
    return [readings[lamp] for lamp in lamps]


def _try(
    lamps: Sequence[GenLamp],
    readings: dict[GenLamp, UnitReading],
    failures: dict[GenLamp, DeviceError],
) -> None:
    """Read each of `lamps` back into `readings`; what fails goes into `failures`."""
    for lamp in lamps:
        try:
            readings[lamp] = _read_back(lamp)
            failures.pop(lamp, None)
        except DeviceError as error:
            failures[lamp] = error


def _read_back(lamp: GenLamp) -> UnitReading:
    reading = lamp.read()
    if reading.output_on:
        lamp.switch_off()
        reading = lamp.read()
    if problem := lamp.problem(reading, should_burn=False):
        raise problem
    return reading


def _not_off(device: str, failures: dict[GenLamp, DeviceError]) -> DeviceError:
    names = ", ".join(str(lamp.unit.lamp) for lamp in failures)
    first, *_, last = [*failures.values(), *failures.values()]
    kinds = {type(error) for error in failures.values()}
    return (kinds.pop() if len(kinds) == 1 else DeviceError)(
        f"{device}: not known to be off: lamp {names}; switch the supplies off by hand ({first})",
        device=device,
        code="lamps-not-off",
        last_exchange=last.last_exchange,
    )
