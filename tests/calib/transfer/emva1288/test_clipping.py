"""The saturation point of cameras whose pixels' distribution is known exactly."""

from dataclasses import replace

import numpy as np
import pytest

from calib.recording.header import Block
from calib.transfer.emva1288.block_figures import BlockFigures
from calib.transfer.emva1288.clipping import carrier_of, clipped_point
from calib.transfer.emva1288.saturation import find_saturation
from calib.transfer.emva1288.series import Series
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera, Image, patterned

MANY = 10**9


def exact(camera: DrawnCamera, exposure_us: float, level: float, share: float) -> BlockFigures:
    """What endless frames would say of a block."""
    mean = camera.expected_dn(exposure_us, level)
    electrons = camera.electrons(exposure_us, level)
    variance = camera.gain**2 * (float(np.mean(electrons)) + camera.read_noise_e**2)
    block = Block(block="0", kind="flat" if level else "dark", exposure_us=exposure_us)
    return BlockFigures(block, MANY, float(np.mean(mean)), 0.0, variance, 0.0, variance,
                        float(np.var(mean)), share, 0.0)  # fmt: skip


@pytest.mark.parametrize("gain", [0.25, 4.0])
@pytest.mark.parametrize("lines", [0.0, 1.0])
def test_it_is_where_the_pixels_say_however_they_are_distributed(gain: float, lines: float) -> None:
    camera = DrawnCamera(gain=gain, read_noise_e=2.0, dark_current_e_per_s=0.0)
    rng = np.random.default_rng(301)
    pattern: Image = patterned(rng, camera, 0.01, 0.01 * lines) + 0.2 * (
        rng.random(camera.shape) > 0.9995
    )
    camera = replace(camera, prnu=pattern, dsnu=np.zeros(camera.shape))
    full = camera.saturation_exposure_us()
    steps = (0.4 * full, 0.85 * full, 1.1 * full)
    flats = tuple(exact(camera, t, 1.0, share) for t, share in zip(steps, (0, 0, 1), strict=True))
    series = Series(flats, (exact(camera, full, 0.0, 0.0),), np.zeros(3, np.int64),
                    np.array(steps), ((0,),), 0, ())  # fmt: skip
    point = find_saturation(series, camera.full_scale_dn)
    carrier = carrier_of(point, series)
    assert carrier == 1
    image = camera.expected_dn(steps[carrier], 1.0)
    found = clipped_point(point, series, carrier, image, camera.full_scale_dn)
    truth = float(np.mean(camera.expected_dn(full, 1.0)))
    # Edgeworth's next terms are the skewness squared: 1/electrons of a sample's spread.
    electrons = truth / gain
    spread = float(np.sqrt(gain * truth + np.var(image)))
    assert found.mean_dn == pytest.approx(truth, abs=spread * 10 / electrons + 0.02)
    assert found.mean_std == pytest.approx(0.0, abs=1e-3 * spread)


def test_a_flat_that_clips_here_and_there_is_not_carried() -> None:
    camera = DrawnCamera()
    flats = tuple(exact(camera, t, 1.0, s) for t, s in ((50.0, 0.0), (95.0, 5e-4), (120.0, 0.9)))
    series = Series(flats, (exact(camera, 95.0, 0.0, 0.0),), np.zeros(3, np.int64),
                    np.array([50.0, 95.0, 120.0]), ((0,),), 0, ())  # fmt: skip
    point = find_saturation(series, camera.full_scale_dn)
    assert point.step == 1
    assert carrier_of(point, series) == 0
