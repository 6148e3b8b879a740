"""Does every device of a bench answer?"""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Protocol

from calib.errors import DarkflatError
from drivers.ports import DeviceIdentity, LightSource
from service.bench.all_off import all_off
from service.bench.lock import BenchLock
from service.bench.open_devices import open_camera, open_monitor, open_shutter
from service.bench.open_light import open_light
from service.bench.settings import BenchSettings
from service.bench.simulated import start_simulated
from service.doctor.finding import Finding


class _Device(Protocol):
    @property
    def identity(self) -> DeviceIdentity: ...

    def close(self) -> None: ...


def look_at_bench(settings: BenchSettings) -> list[Finding]:
    """Open every device, each for itself, ask who it is, and leave the lamps off."""
    lock = BenchLock(settings.id)
    with ExitStack() as resources:
        try:
            lock.acquire()
            resources.callback(lock.release)
            simulated = start_simulated(settings, resources)
        except DarkflatError as error:
            return [_failed(f"bench {settings.id}", error)]
        lights: list[LightSource] = []

        def light() -> LightSource:
            opened = open_light(settings.light, simulated)
            lights.append(opened)
            all_off(opened)
            return opened

        found = [
            _ask("light", light, resources),
            _ask("camera", lambda: open_camera(settings.camera, simulated), resources),
            _ask("monitor", lambda: open_monitor(settings.monitor, simulated), resources),
        ]
        if lights:  # a shutter may be the lamps' own
            shutter = lights[0]
            found.append(
                _ask(
                    "shutter",
                    lambda: open_shutter(settings.shutter, simulated, shutter, None),
                    resources,
                )
            )
        return found


def _ask(name: str, opening: Callable[[], _Device | None], resources: ExitStack) -> Finding:
    try:
        device = opening()
        if device is None:
            return Finding(f"bench: {name}", "ok", "this bench has none")
        resources.callback(device.close)
        who = device.identity
    except DarkflatError as error:
        return _failed(f"bench: {name}", error)
    parts = (who.vendor, who.model, who.serial and f"serial {who.serial}", who.address)
    return Finding(f"bench: {name}", "ok", " ".join(part for part in parts if part))


def _failed(topic: str, error: DarkflatError) -> Finding:
    """The drivers' sentences say what to do themselves."""
    text, _, remedy = str(error).partition("; ")
    return Finding(topic, "missing", text, remedy)
