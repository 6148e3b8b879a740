"""Opens a bench: takes it, starts what is simulated, opens every device, and makes it dark."""

from contextlib import ExitStack
from pathlib import Path

from calib.recording.header import CameraHeader
from service.bench.all_off import all_off
from service.bench.bench import Bench
from service.bench.endings import Endings
from service.bench.lock import BenchLock
from service.bench.open_devices import open_camera, open_monitor, open_shutter
from service.bench.open_light import open_light
from service.bench.operator_shutter import Ask
from service.bench.settings import BenchSettings
from service.bench.simulated import Simulated, start_simulated
from service.bench.target import open_target


def open_bench(bench: Path | str | BenchSettings, *, ask: Ask | None = None) -> Bench:
    """Return the bench, owned by this process, its lamps off and read back.

    Use it as a context manager. However the process ends, except by kill -9, the lamps go off.

    Args:
        bench: A bench file, or its settings.
        ask: Asks a person for the cap, on a bench without a shutter.

    Raises:
        InputError: The bench file cannot be used.
        DeviceBusyError: Another process has it; says which.
        DeviceError: A device is not there or not as it should be; the others are released.
    """
    settings = bench if isinstance(bench, BenchSettings) else BenchSettings.load(Path(bench))
    with ExitStack() as opening:
        lock = BenchLock(settings.id)
        lock.acquire()
        opening.callback(lock.release)
        opened = _open_devices(settings, opening, ask)
        opened.keep(opening.pop_all())
    endings = Endings(opened.close)
    endings.install()
    opened.on_close(endings.remove)
    opened.end_with(endings)
    return opened


def _open_devices(settings: BenchSettings, resources: ExitStack, ask: Ask | None) -> Bench:
    simulated = start_simulated(settings, resources)
    # The light first: it may still burn from a program that was killed, whatever fails after it.
    light = open_light(settings.light, simulated)
    resources.callback(light.close)
    all_off(light)
    monitor = open_monitor(settings.monitor, simulated)
    if monitor is not None:
        resources.callback(monitor.close)
    shutter = open_shutter(settings.shutter, simulated, light, ask)
    resources.callback(shutter.close)
    camera = open_camera(settings.camera, simulated)
    resources.callback(camera.close)
    sensor = _sensor(settings, simulated)
    return Bench(
        settings.id,
        camera=camera,
        light=light,
        monitor=monitor,
        shutter=shutter,
        target=open_target(simulated, ask),
        caps_by_lamps_off=settings.shutter.driver == "lamps_off",
        sensor_columns=None if sensor is None else sensor.columns,
        sensor_rows=None if sensor is None else sensor.rows,
        camera_band=_camera_band(settings, simulated),
        simulated=simulated,
    )


def _sensor(settings: BenchSettings, simulated: Simulated | None) -> CameraHeader | None:
    """A camera without a transport has no feature that tells its size: its model does."""
    if simulated is None or settings.camera.driver != "mock":
        return None
    return simulated.model().camera


def _camera_band(settings: BenchSettings, simulated: Simulated | None) -> str:
    """No camera tells the filter in front of it; a simulated one has that of its model."""
    if simulated is None or not (
        settings.needs_simulated_camera or settings.camera.driver == "mock"
    ):
        return ""
    return simulated.model().camera.band
