"""The simulated GigE Vision camera as an area camera."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from drivers.aravis.camera import AravisCamera
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.contracts.camera import CameraContract, whole
from tests.contracts.simulated_area_camera import (
    AREA,
    REGION,
    SETTINGS,
    SimulatedAreaCameraContract,
)
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.drivers.aravis.conftest import opened

PACED = replace(SETTINGS, line_period_us=2000.0)
"""Frames that a loaded machine can draw in time."""


@pytest.fixture(scope="module")
def area_process(
    world_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[SimulatedCameraProcess]:
    model_path = tmp_path_factory.mktemp("model") / "area.toml"
    AREA.save(model_path)
    with SimulatedCameraProcess(
        model_path, world_path, serial="A1", wait_s=ADDRESS_WAIT_S
    ) as process:
        yield process


@pytest.fixture
def camera(area_process: SimulatedCameraProcess) -> Iterator[AravisCamera]:
    with opened(area_process.address) as camera:
        yield camera


@pytest.fixture
def wanted() -> CameraSettings:
    return PACED


@pytest.mark.aravis
class TestSimulatedGigEAreaCamera(CameraContract, SimulatedAreaCameraContract): ...


@pytest.mark.aravis
def test_says_that_it_is_an_area_camera_and_how_large(camera: AravisCamera, world: World) -> None:
    """By SFNC, WidthMax and HeightMax do not depend on the region that is read out."""
    for settings in (PACED, replace(PACED, **REGION)):
        camera.configure(settings)
        features = camera.features()
        assert features["DeviceScanType"] == "Areascan"
        assert (features["SensorWidth"], features["SensorHeight"]) == ("64", "48")
        assert (features["WidthMax"], features["HeightMax"]) == ("64", "48")
        assert [f.dn.shape for f in whole(camera.frames(2))] == [settings.frame_shape] * 2
