"""The in-process camera as an area camera: what every camera promises, and its own rows."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from drivers.errors import SettingRefusedError
from drivers.mock.camera import MockCamera
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.contracts.camera import CameraContract, whole
from tests.contracts.simulated_area_camera import AREA, SETTINGS, SimulatedAreaCameraContract
from tests.contracts.simulated_camera import MODEL, N_LAMPS


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    world = World.create(tmp_path / "world", N_LAMPS)
    yield world
    world.close()


@pytest.fixture
def camera(world: World) -> MockCamera:
    return MockCamera(AREA, world, seed=2, paced=False)


@pytest.fixture
def wanted() -> CameraSettings:
    return SETTINGS


class TestMockAreaCamera(CameraContract, SimulatedAreaCameraContract): ...


def test_a_frame_takes_one_frame_period(camera: MockCamera) -> None:
    camera.configure(replace(SETTINGS, line_period_us=5000.0))
    stamps = [frame.device_timestamp_ns for frame in whole(camera.frames(3))]
    assert [b - a for a, b in pairwise(stamps)] == [5_000_000] * 2


def test_a_linescan_camera_refuses_rows(world: World) -> None:
    with pytest.raises(SettingRefusedError, match="n_rows = 48, but this camera has no rows"):
        MockCamera(MODEL, world, paced=False).configure(SETTINGS)
