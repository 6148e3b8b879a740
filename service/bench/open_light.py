"""Opens the light that a bench file names. Drivers are imported only when they are used."""

from drivers.ports import LightSource
from service.bench.light_settings import (
    GenLightPart,
    LightPart,
    MightexLightPart,
    MockLightPart,
)
from service.bench.simulated import Simulated


def open_light(part: LightPart, simulated: Simulated | None) -> LightSource:
    """Return the light; the caller closes it."""
    match part:
        case GenLightPart():
            return _gen(part, simulated)
        case MightexLightPart():
            return _mightex(part, simulated)
        case MockLightPart():
            return _mock(part, simulated)


def _gen(part: GenLightPart, simulated: Simulated | None) -> LightSource:
    from drivers.serial.gen import GenLamps  # noqa: PLC0415
    from drivers.serial.gen_lamp import LampRating  # noqa: PLC0415

    addresses = part.addresses
    if not addresses and simulated is not None:
        addresses = tuple(range(1, simulated.simulation.lamps + 1))
    rating = LampRating(
        nominal_current_a=part.nominal_current_a,
        voltage_limit_v=part.voltage_limit_v,
        ramp_step_a=part.ramp_step_a,
        ramp_step_s=part.ramp_step_s,
        tolerance_a=part.tolerance_a,
    )
    return GenLamps.open(
        port_of(part.port, "lamps", simulated),
        addresses=addresses,
        rating=rating,
        hours_path=part.hours_path,
        baudrate=part.baudrate,
        timeout_s=part.timeout_s,
        dark=True,
    )


def _mightex(part: MightexLightPart, simulated: Simulated | None) -> LightSource:
    from drivers.serial.mightex import MightexLed  # noqa: PLC0415

    return MightexLed.open(
        port_of(part.port, "led", simulated),
        channel=part.channel,
        nominal_current_ma=part.nominal_current_ma,
        max_current_ma=part.max_current_ma,
        baudrate=part.baudrate,
    )


def _mock(part: MockLightPart, simulated: Simulated | None) -> LightSource:
    from drivers.mock.light import MockLight  # noqa: PLC0415

    return MockLight(present(simulated).world, tau_s=part.tau_s, ramp_s=part.ramp_s)


def port_of(port: str | None, name: str, simulated: Simulated | None) -> str:
    """Return the port that the bench file names, or the emulator's."""
    return port if port is not None else present(simulated).port(name)


def present(simulated: Simulated | None) -> Simulated:
    """Return the simulation, which the bench file was checked to have."""
    if simulated is None:
        raise ValueError("a mock device on a bench without a simulation")
    return simulated
