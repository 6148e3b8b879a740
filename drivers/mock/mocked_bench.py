"""A bench without any transport: camera, light, monitor and shutter in one shared world."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.forward.model import Model
from drivers.mock.camera import MockCamera
from drivers.mock.light import MockLight
from drivers.mock.monitor import MockMonitor
from drivers.mock.shutter import MockShutter
from drivers.mock.world import World


@dataclass(frozen=True)
class MockedBench:
    """Devices that satisfy `drivers.ports`, and what they stand for.

    Attributes:
        camera: Draws its frames from `model` under the lamps that burn.
        light: The lamps of `world`.
        monitor: Sees the lamps, whatever caps the camera.
        shutter: Moves the cap.
        world: What burns, whether the lens is capped, the sensor's temperature.
        model: The camera's physics; `model.truth()` is what a calibration should find.
    """

    camera: MockCamera
    light: MockLight
    monitor: MockMonitor
    shutter: MockShutter
    world: World
    model: Model


@contextmanager
def mocked_bench(
    folder: Path, *, model: Model | None = None, seed: int = 0
) -> Iterator[MockedBench]:
    """Give a bench while the context lasts; `folder` holds its world.

    Args:
        folder: Where the world's file is put.
        model: The camera's physics and the source; the preset `demo` where None.
        seed: Of the camera's and the monitor's noise.
    """
    chosen = Model.preset("demo") if model is None else model
    world = World.create(folder / "world", chosen.source.lamps or 1)
    bench = MockedBench(
        camera=MockCamera(chosen, world, seed=seed, paced=False),
        light=MockLight(world),
        monitor=MockMonitor(world, np.random.default_rng(seed + 1)),
        shutter=MockShutter(world),
        world=world,
        model=chosen,
    )
    try:
        yield bench
    finally:
        for device in (bench.camera, bench.light, bench.monitor, bench.shutter):
            device.close()
        world.close()
