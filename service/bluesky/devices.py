"""The devices of an open bench, each as Bluesky wants it."""

from dataclasses import dataclass

from drivers.ports import CameraSettings
from service.bench.bench import Bench
from service.bluesky.camera import BenchCamera
from service.bluesky.light import BenchLight
from service.bluesky.monitor import BenchMonitor
from service.bluesky.shutter import BenchShutter


@dataclass(frozen=True)
class BenchDevices:
    """What a plan moves and reads; `monitor` is None on a bench without."""

    light: BenchLight
    camera: BenchCamera
    shutter: BenchShutter
    monitor: BenchMonitor | None


def devices_of(bench: Bench, settings: CameraSettings) -> BenchDevices:
    """Return the devices of `bench`, which stays the caller's, and is to be closed by them.

    Args:
        bench: Open.
        settings: At which the camera is staged.
    """
    monitor = None
    if bench.monitor is not None:
        monitor = BenchMonitor(bench.monitor, f"{bench.id}:monitor")
    return BenchDevices(
        light=BenchLight(bench),
        camera=BenchCamera(bench.camera, settings, source=f"{bench.id}:camera"),
        shutter=BenchShutter(bench),
        monitor=monitor,
    )
