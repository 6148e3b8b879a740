"""Check that a run may go on."""

from service.plan.interlocks import Interlocks
from service.sequencer.errors import InterlockError


def check_temperature(interlocks: Interlocks, temperature_c: float | None, where: str) -> None:
    """Raise InterlockError when the sensor is too cold, too hot, or does not tell."""
    limits = interlocks.camera_temperature_c
    if limits is None:
        return
    if temperature_c is None:
        msg = (
            f"{where}: the plan limits the camera's temperature, but this camera does not tell"
            " it; take interlocks.camera_temperature_c out of the plan"
        )
        raise InterlockError(msg, code="interlock")
    if not limits[0] <= temperature_c <= limits[1]:
        msg = (
            f"{where}: the camera is at {temperature_c:.1f} °C, outside of the plan's"
            f" {limits[0]:g} to {limits[1]:g} °C; let it cool or warm, then resume"
        )
        raise InterlockError(msg, code="interlock")


def check_monitor(interlocks: Interlocks, current_a: float | None, where: str) -> None:
    """Raise InterlockError when the monitor reads too little, too much, or is not there."""
    limits = interlocks.monitor_a
    if limits is None:
        return
    if current_a is None:
        msg = f"{where}: the plan limits the monitor's current, but this bench has no monitor"
        raise InterlockError(msg, code="interlock")
    if not limits[0] <= current_a <= limits[1]:
        msg = (
            f"{where}: the monitor reads {current_a:.4g} A, outside of the plan's"
            f" {limits[0]:g} to {limits[1]:g} A; look at the lamps, then resume"
        )
        raise InterlockError(msg, code="interlock")
