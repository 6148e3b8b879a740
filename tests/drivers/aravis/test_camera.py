from dataclasses import replace
from typing import Any

import pytest

from drivers.ports import CameraSettings, LinescanCamera
from tests.contracts.camera import CameraContract
from tests.contracts.simulated_camera import SETTINGS, SimulatedCameraContract, lit

__all__ = ["lit"]


@pytest.mark.aravis
class TestSimulatedGigECamera(CameraContract, SimulatedCameraContract): ...


@pytest.mark.hardware
class TestCameraOnTheBench(CameraContract):
    @pytest.fixture
    def camera(self, hardware_bench: Any) -> LinescanCamera:
        return hardware_bench.camera

    @pytest.fixture
    def wanted(self, camera: LinescanCamera) -> CameraSettings:
        columns = int(camera.features().get("WidthMax") or camera.features()["SensorWidth"])
        return replace(SETTINGS, n_columns=columns, line_period_us=1000.0, pixel_format="Mono8")
