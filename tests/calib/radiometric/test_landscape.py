import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.radiometric.landscape import Landscape

SCENE = Landscape(sky=30.0, field=18.0, woods=6.0)
SHAPE = (240, 512)


def test_the_same_state_gives_the_same_landscape_and_another_does_not():
    first, same, other = (SCENE.image(*SHAPE, default_rng(seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, same)
    assert (first != other).any()


@pytest.mark.parametrize("seed", range(5))
def test_the_sweep_starts_in_the_sky_and_ends_above_the_ground(seed):
    image = SCENE.image(*SHAPE, default_rng(seed))
    sky = SCENE.is_sky(image)
    assert image.shape == SHAPE
    assert image.min() >= 0
    assert sky[: int(0.14 * SHAPE[0])].all()
    assert sky[:, -1].all()
    assert 0.3 < 1 - sky[-1].mean() < 0.7
    # above the horizon nothing but sky: once a line has reached it, it stays there
    assert (np.diff(sky.astype(int), axis=1) >= 0).all()


@pytest.mark.parametrize("shape", [(1, 64), (64, 1), (5, 7)])
def test_small_images_can_be_had(shape):
    image = SCENE.image(*shape, default_rng(1))
    assert image.shape == shape
    assert np.isfinite(image).all()


def test_fields_scatter_about_their_mean():
    means = [
        SCENE.image(*SHAPE, default_rng(seed))[-60:, : SHAPE[1] // 5].mean() for seed in range(40)
    ]
    assert abs(np.mean(means) - 18.0) < 4 * np.std(means, ddof=1) / np.sqrt(40) + 0.3


@pytest.mark.parametrize(
    "change", [{"sky": -1.0}, {"contrast": -0.1}, {"horizon": 1.1}, {"sky_lines": -0.1}]
)
def test_a_landscape_that_cannot_be_is_refused(change):
    with pytest.raises(InputError) as error:
        Landscape(**{"sky": 1.0, "field": 1.0, "woods": 1.0, **change})
    assert error.value.code == "bad-landscape"
