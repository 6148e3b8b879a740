"""Switching every supply off, and knowing of each lamp whether it is."""

from collections.abc import Sequence
from contextlib import suppress

from drivers.errors import DeviceError
from drivers.serial.gen_lamp import GenLamp
from drivers.serial.gen_units import GenUnits, UnitReading


def read_back_off(units: GenUnits, lamps: Sequence[GenLamp]) -> list[UnitReading]:
    """Send the group command, then read each supply back; one that is still on is told alone.

    Raises DeviceError with code `lamps-not-off` after every lamp was tried, naming those that are
    not known to be off; of the line's class where that alone is at fault.
    """
    readings: list[UnitReading] = []
    failures: dict[GenLamp, DeviceError] = {}
    with units.link.lock:
        with suppress(DeviceError):  # what is wrong shows when each lamp is read back
            units.all_off()
        for lamp in lamps:
            try:
                readings.append(_read_back(lamp))
            except DeviceError as error:
                failures[lamp] = error
    if failures:
        raise _not_off(units.link.device, failures)
    return readings


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
