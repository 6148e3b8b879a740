"""A simulated GigE Vision camera over loopback, and what the tests do with it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from drivers.aravis.camera import AravisCamera
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.contracts.simulated_camera import ADDRESS_WAIT_S, MODEL, N_LAMPS, SETTINGS


def aravis_is_there() -> bool:
    try:
        import gi

        gi.require_version("Aravis", "0.8")
    except (ImportError, ValueError):
        return False
    return True


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if not aravis_is_there():
        for item in items:
            if item.get_closest_marker("aravis"):
                item.add_marker(pytest.mark.skip(reason="Aravis is not installed"))


@pytest.fixture(scope="session")
def world_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("world") / "world"
    World.create(path, N_LAMPS).close()
    return path


@pytest.fixture(scope="session")
def model_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "contract.toml"
    MODEL.save(path)
    return path


@pytest.fixture(scope="module")
def running(model_path: Path, world_path: Path) -> Iterator[SimulatedCameraProcess]:
    with SimulatedCameraProcess(
        model_path, world_path, serial="C1", wait_s=ADDRESS_WAIT_S
    ) as process:
        yield process


@pytest.fixture
def process(running: SimulatedCameraProcess) -> Iterator[SimulatedCameraProcess]:
    """The camera without faults; whatever a test did to it is mended after."""
    yield running
    if running.is_running:
        running.wake()
        running.lose_packets(0.0)
    else:
        running.start()


@pytest.fixture
def world(world_path: Path) -> Iterator[World]:
    world = World(world_path)
    yield world
    world.cap(False)
    world.close()


@pytest.fixture
def wanted() -> CameraSettings:
    return SETTINGS


@contextmanager
def opened(address: str, **options: object) -> Iterator[AravisCamera]:
    camera = AravisCamera.open(address, **options)  # type: ignore[arg-type]
    try:
        yield camera
    finally:
        camera.close()


@pytest.fixture
def camera(process: SimulatedCameraProcess) -> Iterator[AravisCamera]:
    with opened(process.address) as camera:
        yield camera
