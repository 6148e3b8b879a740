"""Switch a light off and make sure of it."""

from drivers.errors import DeviceError
from drivers.ports import LightSource, LightState


def all_off(light: LightSource) -> LightState:
    """Switch every lamp off and return what was read back.

    Raises:
        DeviceError: With code `lamps-not-off`; says what has to be switched off by hand.
    """
    try:
        state = light.off()
    except DeviceError as error:
        raise _not_off(str(error), error.device, error.last_exchange) from error
    lit = [str(i + 1) for i, lamp in enumerate(state.lamps) if lamp.on]
    if lit or state.level > 0:
        reason = f"lamp {', '.join(lit)} reads back as on" if lit else "its level is not 0"
        raise _not_off(reason, light.identity.address)
    return state


def _not_off(reason: str, device: str, last_exchange: str = "") -> DeviceError:
    return DeviceError(
        f"the lamps could not be read back as off ({reason}): switch them off by hand",
        device=device,
        code="lamps-not-off",
        last_exchange=last_exchange,
    )
