"""What a camera promises whose pixels the forward model draws: they obey the model and the world.

Subclass `SimulatedCameraContract` and give `camera`, `world`. The expected codes are worked out
here from the coefficients DN = L VE QE t + DN0, not by the code that draws them.
"""

import time
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.forward.model import Model
from drivers.mock.world import World
from drivers.pixel_formats import FORMATS
from drivers.ports import CameraSettings, LinescanCamera, PixelFormat
from tests.contracts.camera import whole

ADDRESS_WAIT_S = 240.0
"""Other tests may be at the address: there is one simulated camera per address."""

N_LAMPS = 3
RADIANCE = (11.0, 9.0, 10.0)
COLUMNS = 512
SETTINGS = CameraSettings(
    exposure_us=60.0,
    line_period_us=100.0,
    frame_lines=64,
    n_columns=COLUMNS,
    pixel_format="Mono12",
)

MODEL_TEXT = f"""
[camera]
model = "contract"
serial = "C1"
columns = {COLUMNS}
bit_depth = 12
line_period_us = 100.0

[source]
kind = "sphere"
lamps = {N_LAMPS}
radiance_unit = "W m-2 sr-1"

[effects.illumination]
radiance = {list(RADIANCE)}

[effects.vignette]
axis_column = 250.0
focal_length_columns = 900.0

[effects.responsivity]
electrons_per_radiance_us = 5.0
prnu_std = 0.02
prnu_seed = 7

[effects.shot_noise]

[effects.read_noise]
std_e = 10.0

[effects.system_gain]
dn_per_e = 0.2

[effects.offset]
mean_dn = 50.0
pattern_std_dn = 2.0
pattern_seed = 7

[effects.adc]
bit_depth = 12
"""
MODEL = Model.loads(MODEL_TEXT)


def expected_dn(settings: CameraSettings, lamps: tuple[float, ...]) -> Columns:
    """Mean codes of the ADC under lamps of these emissions, (n_columns,)."""
    truth = MODEL.truth()
    radiance = sum(e * r for e, r in zip(lamps, RADIANCE, strict=True))
    gain = 10 ** (settings.gain_db / 20)
    signal = radiance * truth.vignette * truth.responsivity * settings.exposure_us * gain
    region = slice(settings.first_column, settings.first_column + settings.n_columns)
    return (signal + truth.dark_offset_dn + settings.black_level_dn)[region]


def lines_of(camera: LinescanCamera, n_frames: int = 12) -> NDArray[np.float64]:
    """All lines of `n_frames` frames, (n_lines, n_columns)."""
    return np.concatenate([f.dn.astype(np.float64) for f in whole(camera.frames(n_frames))])


def assert_mean(lines: NDArray[np.float64], expected: Columns, *, sigmas: float = 5.0) -> None:
    """The columns' means scatter about `expected` as their own noise says, and no more.

    `sigmas` standard errors are allowed; whoever asks it of many frames allows more.
    """
    z = (lines.mean(0) - expected) / (lines.std(0, ddof=1) / np.sqrt(len(lines)))
    assert abs(z.mean()) < sigmas / np.sqrt(z.size)
    assert abs(z.std() - 1) < sigmas / np.sqrt(2 * z.size)


@pytest.fixture
def lit(world: World) -> World:
    """A world with all lamps at their nominal radiance, uncapped."""
    world.cap(False)
    for lamp in range(N_LAMPS):
        world.drive(lamp, 1.0)
    return world


class SimulatedCameraContract:
    """Promises of simulated cameras, on top of `CameraContract`."""

    def test_mean_is_what_the_model_says(self, camera: LinescanCamera, lit: World) -> None:
        used = camera.configure(SETTINGS)
        assert_mean(lines_of(camera), expected_dn(used, (1, 1, 1)))

    @pytest.mark.parametrize(
        "change",
        [
            {"exposure_us": 31.25},
            {"gain_db": 3.0, "exposure_us": 40.0},
            {"black_level_dn": 100.0},
            {"n_columns": 128, "first_column": 320},
        ],
        ids="-".join,
    )
    def test_mean_follows_what_was_written(
        self, camera: LinescanCamera, lit: World, change: dict[str, float]
    ) -> None:
        used = camera.configure(replace(SETTINGS, **change))  # type: ignore[arg-type]
        assert_mean(lines_of(camera), expected_dn(used, (1, 1, 1)))

    def test_mean_follows_each_lamp(self, camera: LinescanCamera, lit: World) -> None:
        used = camera.configure(SETTINGS)
        lit.drive(0, 0.25)
        lit.drive(1, 0.0)
        assert_mean(lines_of(camera), expected_dn(used, (0.25, 0, 1)))

    def test_cap_leaves_only_the_offset(self, camera: LinescanCamera, lit: World) -> None:
        used = camera.configure(SETTINGS)
        lit.cap(True)
        assert_mean(lines_of(camera), expected_dn(used, (0, 0, 0)))
        lit.cap(False)

    def test_lamps_off_are_as_dark_as_the_cap(self, camera: LinescanCamera, lit: World) -> None:
        used = camera.configure(SETTINGS)
        for lamp in range(N_LAMPS):
            lit.drive(lamp, 0.0)
        assert_mean(lines_of(camera), expected_dn(used, (0, 0, 0)))

    def test_too_much_light_stops_at_the_highest_code(
        self, camera: LinescanCamera, lit: World
    ) -> None:
        camera.configure(replace(SETTINGS, line_period_us=1000.0, exposure_us=900.0))
        (frame,) = whole(camera.frames(1))
        assert np.all(frame.dn == 4095)

    def test_no_noise_is_ever_repeated(self, camera: LinescanCamera, lit: World) -> None:
        camera.configure(SETTINGS)
        frames = [frame.dn.astype(np.float64) for frame in whole(camera.frames(6))]
        mean = np.mean(frames, axis=0).mean(0)
        noise = np.array([(frame - mean).ravel() for frame in frames])
        correlation = np.corrcoef(noise)[np.triu_indices(len(frames), 1)]
        assert np.all(np.abs(correlation) < 5 / np.sqrt(noise.shape[1]))

    def test_noise_is_new_after_a_pause(self, camera: LinescanCamera, lit: World) -> None:
        camera.configure(SETTINGS)
        (before,) = whole(camera.frames(1))
        (after,) = whole(camera.frames(1))
        assert not np.array_equal(before.dn, after.dn)

    @pytest.mark.parametrize("name", list(FORMATS))
    def test_every_format_carries_the_same_picture(
        self, camera: LinescanCamera, lit: World, name: PixelFormat
    ) -> None:
        used = camera.configure(replace(SETTINGS, pixel_format=name))
        lines = lines_of(camera, 6)
        assert lines.max() < 1 << FORMATS[name].bits
        scale = 2.0 ** (FORMATS[name].bits - 12)
        expected = expected_dn(used, (1, 1, 1)) * scale
        if scale < 1:  # truncation takes half a code of what the ADC rounded, on average
            expected -= (1 - scale) / 2
        assert_mean(lines, expected)

    def test_temperature_is_that_of_the_world(self, camera: LinescanCamera, lit: World) -> None:
        camera.configure(SETTINGS)
        lit.warm(31.5)
        deadline_s = time.monotonic() + 10.0
        while camera.temperature_c() != 31.5 and time.monotonic() < deadline_s:
            time.sleep(0.02)
        (frame,) = whole(camera.frames(1))
        assert frame.sensor_temperature_c == 31.5
        lit.warm(25.0)
