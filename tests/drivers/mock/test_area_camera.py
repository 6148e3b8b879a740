"""The in-process camera as an area camera: what every camera promises, and its own rows."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from drivers.errors import SettingRefusedError
from drivers.mock.camera import MockCamera
from drivers.mock.world import World
from drivers.ports import CameraSettings
from tests.contracts.camera import CameraContract, whole
from tests.contracts.simulated_camera import MODEL, RADIANCE

ROWS, COLUMNS = 48, 64
CAMERA = MODEL.camera.model_copy(update={"rows": ROWS, "columns": COLUMNS})
AREA: Model = replace(MODEL, camera=CAMERA).with_effect(Vignette(focal_length_columns=70.0))
SETTINGS = CameraSettings(
    exposure_us=60.0, line_period_us=100.0, frame_lines=1, n_columns=COLUMNS, n_rows=ROWS
)


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    world = World.create(tmp_path / "world", len(RADIANCE))
    yield world
    world.close()


@pytest.fixture
def camera(world: World) -> MockCamera:
    return MockCamera(AREA, world, seed=2, paced=False)


@pytest.fixture
def wanted() -> CameraSettings:
    return SETTINGS


class TestMockAreaCamera(CameraContract): ...


REGION = {"n_rows": 16, "first_row": 30, "n_columns": 24, "first_column": 8}


@pytest.mark.parametrize("change", [{}, REGION], ids=["whole", "region"])
def test_pixels_obey_the_model(world: World, camera: MockCamera, change: dict[str, int]) -> None:
    for lamp in range(len(RADIANCE)):
        world.drive(lamp, 1.0)
    used = camera.configure(replace(SETTINGS, **change))  # type: ignore[arg-type]
    frames = np.array([frame.dn.astype(np.float64) for frame in whole(camera.frames(100))])
    truth = AREA.truth()
    expected = sum(RADIANCE) * truth.vignette * truth.responsivity * 60.0 + truth.dark_offset_dn
    rows = slice(used.first_row, used.first_row + frames.shape[1])
    columns = slice(used.first_column, used.first_column + frames.shape[2])
    assert frames.shape[1:] == used.frame_shape
    z = (frames.mean(0) - expected[rows, columns]) / (frames.std(0, ddof=1) / 10.0)
    # Student's t with 99 degrees of freedom: variance 99 / 97.
    assert abs(z.mean()) < 5 / np.sqrt(z.size)
    assert abs(z.std() - 1.01) < 5 / np.sqrt(2 * z.size)


def test_a_frame_takes_one_frame_period(camera: MockCamera) -> None:
    camera.configure(replace(SETTINGS, line_period_us=5000.0))
    stamps = [frame.device_timestamp_ns for frame in whole(camera.frames(3))]
    assert [b - a for a, b in pairwise(stamps)] == [5_000_000] * 2


REFUSED = {
    "rows of a linescan camera": (MODEL, SETTINGS, "n_rows = 48, but this camera has no rows"),
    "no rows of an area camera": (
        AREA, replace(SETTINGS, n_rows=None), "n_rows = None, but this camera has 48 rows",
    ),
    "several frames as one": (AREA, replace(SETTINGS, frame_lines=2), "frame_lines = 2"),
    "rows beyond the last": (AREA, replace(SETTINGS, first_row=1), "first_row = 1 is outside"),
}  # fmt: skip


@pytest.mark.parametrize(("model", "settings", "said"), REFUSED.values(), ids=REFUSED)
def test_refuses_rows_that_it_does_not_have(
    world: World, model: Model, settings: CameraSettings, said: str
) -> None:
    with pytest.raises(SettingRefusedError, match=said) as caught:
        MockCamera(model, world, paced=False).configure(settings)
    assert caught.value.code == "setting-out-of-range"
