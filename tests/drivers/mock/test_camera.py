from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError
from drivers.mock.camera import MockCamera
from drivers.mock.world import World
from drivers.ports import CameraSettings, LostFrame
from tests.contracts.camera import CameraContract, whole
from tests.contracts.simulated_camera import (
    MODEL,
    N_LAMPS,
    SETTINGS,
    SimulatedCameraContract,
    lit,
)

__all__ = ["lit"]


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    world = World.create(tmp_path / "world", N_LAMPS)
    yield world
    world.close()


@pytest.fixture(params=[True, False], ids=["paced", "unpaced"])
def camera(request: pytest.FixtureRequest, world: World) -> MockCamera:
    return MockCamera(MODEL, world, paced=request.param, frame_timeout_s=0.2)


@pytest.fixture
def wanted() -> CameraSettings:
    return SETTINGS


class TestMockCamera(CameraContract, SimulatedCameraContract): ...


def test_same_seed_same_frames(world: World) -> None:
    def drawn(seed: int) -> bytes:
        camera = MockCamera(MODEL, world, seed, paced=False)
        camera.configure(SETTINGS)
        return b"".join(frame.dn.tobytes() for frame in whole(camera.frames(2)))

    assert drawn(3) == drawn(3)
    assert drawn(3) != drawn(4)


def test_unpaced_clock_runs_on_by_the_frame_period(world: World) -> None:
    camera = MockCamera(MODEL, world, paced=False)
    camera.configure(SETTINGS)
    stamps = [frame.device_timestamp_ns for frame in whole(camera.frames(4))]
    assert [b - a for a, b in pairwise(stamps)] == [6_400_000] * 3


def test_paced_frames_do_not_overlap_in_time(world: World) -> None:
    camera = MockCamera(MODEL, world)
    camera.configure(SETTINGS)
    stamps = [frame.device_timestamp_ns for frame in whole(camera.frames(4))]
    assert all(b - a >= 6_400_000 - 1 for a, b in pairwise(stamps))


def test_lost_frames_are_named_and_taken_again(camera: MockCamera) -> None:
    camera.configure(SETTINGS)
    camera.faults.to_lose = 2
    frames = list(camera.frames(3))
    assert [isinstance(frame, LostFrame) for frame in frames] == [True, True, False, False, False]
    assert [frame.frame_id for frame in frames] == [1, 2, 3, 4, 5]


def test_too_many_lost_frames_are_an_error(camera: MockCamera) -> None:
    camera.configure(SETTINGS)
    camera.faults.to_lose = 1000
    with pytest.raises(DeviceError) as caught:
        list(camera.frames(3))
    assert caught.value.code == "frames-lost"


def test_stalled_camera_times_out(camera: MockCamera) -> None:
    camera.configure(SETTINGS)
    camera.faults.stalled = True
    with pytest.raises(DeviceTimeoutError) as caught:
        list(camera.frames(1))
    assert caught.value.code == "frame-timeout"


def test_vanished_camera_is_lost_and_may_come_back(camera: MockCamera) -> None:
    camera.configure(SETTINGS)
    frames = camera.frames(1000)
    next(frames)
    camera.faults.vanished = True
    with pytest.raises(DeviceLostError) as caught:
        list(frames)
    assert caught.value.code == "control-lost"
    assert "C1" in str(caught.value)
    camera.faults.vanished = False
    camera.configure(SETTINGS)
    assert len(whole(camera.frames(1))) == 1


def test_frames_before_configure_are_refused(camera: MockCamera) -> None:
    with pytest.raises(DeviceError) as caught:
        next(camera.frames(1))
    assert caught.value.code == "camera-not-configured"
