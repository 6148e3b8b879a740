"""Bad pixels, and an image in photo-electrons."""

from collections.abc import Callable

import numpy as np
import pytest

from calib.errors import InputError
from calib.transfer.two_exposures.bad_pixels import Defect, bad_pixels, robust_z
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.non_uniformity import corrected
from calib.transfer.two_exposures.pixel_maps import PixelMaps
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sanuc import sanuc
from tests.calib.transfer.two_exposures.scores import spread_of
from tests.calib.transfer.two_exposures.stacks import Sensor, drawn_pair, pair_of, pooled_of

SEVERAL = 4.0  # standard errors


def test_planted_defects_are_found_with_their_reasons() -> None:
    sensor = Sensor.flat(4000, 2000.0, 5.0, spread=0.01)
    rng = np.random.default_rng(1)
    first = sensor.frames(300, 1).astype(np.int64)
    second = sensor.frames(300, 2, 2.0).astype(np.int64)
    for dn in (first, second):
        dn[:, 0] = 500
        dn[:, 1] += 200
        dn[:, 2] += np.rint(90 * rng.normal(size=300)).astype(np.int64)
        dn[:, 3] += 300 + np.rint(90 * rng.normal(size=300)).astype(np.int64)
    second[:, 4] = first[:, 4] + rng.integers(-1, 2, 300)
    second[7, 5] = 65535
    # A pixel of eight times the gain at an eighth of the light.
    for dn, light in ((first, 250.0), (second, 500.0)):
        dn[:, 6] = np.rint(8.0 * rng.poisson(light, 300) + 100.0)
    found = bad_pixels(sanuc(pair_of(first.astype(np.uint16), second.astype(np.uint16))))
    wanted = {
        0: Defect.DEAD,
        1: Defect.BIAS,
        2: Defect.NOISY,
        3: Defect.BIAS | Defect.NOISY | Defect.HOT,
        4: Defect.DEAD,
        5: Defect.CLIPPED,
        6: Defect.GAIN,
    }
    for pixel, defect in wanted.items():
        assert Defect(int(found.defect[pixel])) & defect == defect, pixel
    assert not found.bad[7:].any()
    assert found.counts()["hot"] == 1


@pytest.mark.parametrize("method", [sanuc, s3nuc])
def test_good_pixels_that_are_merely_noisy_are_not_bad(
    method: Callable[[ExposurePair], PixelMaps],
) -> None:
    sensor = Sensor.flat(5000, 300.0, 10.0, spread=0.05)
    maps = method(drawn_pair(sensor, 50, key=1))
    assert bad_pixels(maps).bad.mean() < 1e-3


def test_z_counts_true_scatter_and_uncertainty() -> None:
    rng = np.random.default_rng(2)
    lit = rng.uniform(1.0, 3.0, 20_000)
    std = 4.0 * np.where(rng.random(20_000) < 0.1, 10.0, 1.0) * lit
    values = rng.normal(5.0, 3.0, 20_000) + rng.normal(0.0, 4.0 * lit)
    z = robust_z(values, std, lit)
    spread, error = spread_of(z)
    # The true scatter is taken at the typical uncertainty; the median deviation has 2 x the error.
    assert abs(spread - 1.0) < 0.05 + SEVERAL * 2 * error
    assert (robust_z(np.array([np.nan, 1.0]), np.ones(2), np.ones(2)) == 0).all()


def test_an_image_becomes_photoelectrons_with_their_uncertainty() -> None:
    sensor = Sensor.flat(4000, 5000.0, 8.0, gain=0.6, spread=0.05)
    maps = sanuc(drawn_pair(sensor, 500, key=3))
    frame = sensor.frames(1, 99, 1.5)[0].astype(np.float64)
    variance = sensor.gain**2 * (7500.0 + 64.0)
    image = corrected(frame, maps, image_variance_dn2=variance)
    z = (image.photoelectrons - 7500.0) / image.std
    spread, error = spread_of(z)
    assert abs(spread - 1.0) < 0.1 + SEVERAL * error
    mean = image.photoelectrons.mean() / 7500.0 - 1.0
    assert abs(mean) < 2 * (10 / 499) ** 2 + SEVERAL * np.sqrt(10 / 499 / 4000)


def test_one_gain_for_all_makes_a_far_quieter_image() -> None:
    sensor = Sensor.flat(4000, 5000.0, 8.0, gain=0.6)
    first, second = sensor.frames(100, 1), sensor.frames(100, 2, 2.0)
    maps, gain = sanuc(pair_of(first, second)), pooled_of(first, second).system_gain_dn_per_e
    frame = sensor.frames(200, 99).mean(axis=0)
    own, one = corrected(frame, maps), corrected(frame, maps, gain=gain)
    known = np.isfinite(own.photoelectrons)
    assert one.photoelectrons[known].std() < 0.1 * own.photoelectrons[known].std()
    assert abs(one.photoelectrons.mean() / 5000.0 - 1.0) < SEVERAL * gain.std / gain.value


def test_an_image_of_another_size_is_refused() -> None:
    maps = sanuc(drawn_pair(Sensor.flat(30, 500.0, 5.0), 10, key=1))
    with pytest.raises(InputError) as refused:
        corrected(np.zeros(31), maps)
    assert refused.value.code == "wrong-shape"
