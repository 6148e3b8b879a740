"""What an area camera promises whose pixels the forward model draws.

Subclass `SimulatedAreaCameraContract` and give `camera`, `world`.
"""

from dataclasses import replace

import numpy as np
import pytest

from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from drivers.errors import SettingRefusedError
from drivers.mock.world import World
from drivers.ports import CameraSettings, LinescanCamera
from tests.contracts.camera import whole
from tests.contracts.simulated_camera import MODEL, RADIANCE

ROWS, COLUMNS = 48, 64
CAMERA = MODEL.camera.model_copy(update={"rows": ROWS, "columns": COLUMNS})
AREA: Model = replace(MODEL, camera=CAMERA).with_effect(Vignette(focal_length_columns=70.0))
SETTINGS = CameraSettings(
    exposure_us=60.0, line_period_us=100.0, frame_lines=1, n_columns=COLUMNS, n_rows=ROWS
)
REGION = {"n_rows": 16, "first_row": 30, "n_columns": 24, "first_column": 8}


class SimulatedAreaCameraContract:
    """Promises of simulated area cameras, on top of `CameraContract`."""

    @pytest.mark.parametrize("change", [{}, REGION], ids=["whole", "region"])
    def test_pixels_obey_the_model(
        self, world: World, camera: LinescanCamera, change: dict[str, int]
    ) -> None:
        for lamp in range(len(RADIANCE)):
            world.drive(lamp, 1.0)
        used = camera.configure(replace(SETTINGS, **change))  # type: ignore[arg-type]
        frames = np.array([frame.dn.astype(np.float64) for frame in whole(camera.frames(100))])
        truth = AREA.truth()
        light = sum(RADIANCE) * truth.vignette * truth.responsivity * used.exposure_us
        rows = slice(used.first_row, used.first_row + frames.shape[1])
        columns = slice(used.first_column, used.first_column + frames.shape[2])
        expected = (light + truth.dark_offset_dn)[rows, columns]
        assert frames.shape[1:] == used.frame_shape
        z = (frames.mean(0) - expected) / (frames.std(0, ddof=1) / 10.0)
        # Student's t with 99 degrees of freedom: variance 99 / 97.
        assert abs(z.mean()) < 5 / np.sqrt(z.size)
        assert abs(z.std() - 1.01) < 5 / np.sqrt(2 * z.size)

    @pytest.mark.parametrize(
        "change",
        [{"n_rows": None}, {"frame_lines": 2}, {"first_row": 1}],
        ids=["a linescan camera's", "several frames as one", "rows beyond the last"],
    )
    def test_refuses_what_no_area_camera_does(
        self, camera: LinescanCamera, change: dict[str, int | None]
    ) -> None:
        with pytest.raises(SettingRefusedError) as caught:
            camera.configure(replace(SETTINGS, **change))  # type: ignore[arg-type]
        assert caught.value.code == "setting-out-of-range"
