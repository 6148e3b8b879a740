import os
from collections.abc import Iterator
from dataclasses import replace

import pytest

from drivers.aravis.camera import AravisCamera
from drivers.ports import CameraSettings
from tests.contracts.camera import CameraContract
from tests.contracts.simulated_camera import SETTINGS, SimulatedCameraContract, lit

__all__ = ["lit"]


@pytest.mark.aravis
class TestSimulatedGigECamera(CameraContract, SimulatedCameraContract): ...


@pytest.mark.hardware
class TestCameraOnTheBench(CameraContract):
    """Names the camera in the environment: DARKFLAT_CAMERA=192.168.1.10 or =Vendor-Serial."""

    @pytest.fixture
    def camera(self) -> Iterator[AravisCamera]:
        address = os.environ.get("DARKFLAT_CAMERA")
        if not address:
            pytest.skip("DARKFLAT_CAMERA names no camera")
        camera = AravisCamera.open(address)
        yield camera
        camera.close()

    @pytest.fixture
    def wanted(self, camera: AravisCamera) -> CameraSettings:
        columns = int(camera.features().get("WidthMax") or camera.features()["SensorWidth"])
        return replace(SETTINGS, n_columns=columns, line_period_us=1000.0, pixel_format="Mono8")
