"""Opens the camera, the monitor and the shutter. Drivers are imported only when they are used."""

import numpy as np

from drivers.ports import LightSource, LinescanCamera, Monitor, Shutter
from service.bench.camera_settings import AravisCameraPart, CameraPart, MockCameraPart
from service.bench.lamps_off_shutter import LampsOffShutter
from service.bench.monitor_settings import (
    KeithleyMonitorPart,
    MockMonitorPart,
    MonitorPart,
    NoMonitorPart,
)
from service.bench.open_light import port_of, present
from service.bench.operator_shutter import Ask, OperatorShutter
from service.bench.shutter_settings import (
    LampsOffShutterPart,
    MockShutterPart,
    OperatorShutterPart,
    RelayShutterPart,
    ShutterPart,
)
from service.bench.simulated import Simulated


def open_camera(part: CameraPart, simulated: Simulated | None) -> LinescanCamera:
    """Return the camera; the caller closes it."""
    match part:
        case AravisCameraPart():
            from drivers.aravis.camera import AravisCamera  # noqa: PLC0415

            address = part.address or present(simulated).camera_address
            return AravisCamera.open(address, packet_size=part.packet_size)
        case MockCameraPart():
            from drivers.mock.camera import MockCamera  # noqa: PLC0415

            known = present(simulated)
            model = known.model()
            camera = MockCamera(model, known.world, known.simulation.seed, paced=part.paced)
            known.reseeding.append(camera.draw_afresh)
            return camera


def open_monitor(part: MonitorPart, simulated: Simulated | None) -> Monitor | None:
    """Return the monitor, None where the bench has none; the caller closes it."""
    match part:
        case KeithleyMonitorPart():
            from drivers.serial.keithley6485 import Keithley6485  # noqa: PLC0415

            return Keithley6485.open(
                port_of(part.port, "monitor", simulated),
                range_a=part.range_a,
                nplc=part.nplc,
                mains_hz=part.mains_hz,
                baudrate=part.baudrate,
                timeout_s=part.timeout_s,
            )
        case MockMonitorPart():
            from drivers.mock.monitor import MockMonitor  # noqa: PLC0415

            known = present(simulated)
            monitor = MockMonitor(
                known.world,
                np.random.default_rng(known.simulation.seed),
                integration_s=part.integration_s,
                range_a=part.range_a,
            )
            known.reseeding.append(monitor.draw_afresh)
            return monitor
        case NoMonitorPart():
            return None


def open_shutter(
    part: ShutterPart, simulated: Simulated | None, light: LightSource, ask: Ask | None
) -> Shutter:
    """Return the shutter; the caller closes it."""
    match part:
        case RelayShutterPart():
            from drivers.serial.rly16 import RelayShutter  # noqa: PLC0415

            return RelayShutter.open(
                port_of(part.port, "shutter", simulated),
                relay=part.relay,
                capped_when_on=part.capped_when_on,
                travel_s=part.travel_s,
            )
        case MockShutterPart():
            from drivers.mock.shutter import MockShutter  # noqa: PLC0415

            return MockShutter(present(simulated).world)
        case LampsOffShutterPart():
            return LampsOffShutter(light, afterglow_s=part.afterglow_s)
        case OperatorShutterPart():
            return OperatorShutter(ask)
