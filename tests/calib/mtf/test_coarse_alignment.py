import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import NotDeterminedError
from calib.mtf.assembly.coarse_alignment import coarse_alignment
from calib.mtf.geometry import Alignment
from calib.mtf.grating.grating import Grating
from calib.mtf.scan_images import ScanImages
from tests.calib.mtf.simulated import ORDERS_12, ORDERS_24, PAPER, SMALL, misaligned, record

ENOUGH_UM = 1.0
"""A tenth of the finest period, from where the fit finds its way."""


@pytest.mark.parametrize(("tilt_deg", "scale"), [(0.0, 0.0), (0.1, 1e-3), (-0.4, -4e-3)])
def test_every_pixel_is_placed_well_enough_to_start_a_fit(tilt_deg: float, scale: float) -> None:
    rng = default_rng()
    drawn = misaligned(rng)
    bench = Alignment(drawn.shift_um, scale, np.radians(tilt_deg), drawn.stage_um)
    case = record(rng, (96, 96), alignment=bench)
    found = coarse_alignment(case.scan)
    assert found.without_pattern == ()
    true, ours = case.bench.sampling, case.scan.sampling(found.alignment)
    first = None
    for one, other in zip(true.positions_um(), ours.positions_um(), strict=True):
        away = (one - other)[:, ::95, ::95].reshape(2, -1).T  # corners
        first = away[0] if first is None else first
        centroid = first - ORDERS_24.harmonics.shortest(first)
        assert np.hypot(*(away - centroid).T).max() < 3 * ENOUGH_UM  # 2 µm are the PSF's centroid


def test_a_stage_that_went_far_astray_is_found_where_it_went() -> None:
    rng = default_rng()
    stage = np.zeros((PAPER.positions, 2))
    stage[11] = (57.0, -31.0)
    case = record(rng, alignment=Alignment(stage_um=stage))
    found = coarse_alignment(case.scan).alignment.stage_um
    assert found is not None
    middle = np.median(found, axis=0)
    np.testing.assert_allclose(found[11] - middle, stage[11], atol=ENOUGH_UM)
    np.testing.assert_allclose(np.delete(found, 11, 0) - middle, 0, atol=ENOUGH_UM)


def test_a_frame_without_the_pattern_is_told_from_the_others() -> None:
    rng = default_rng()
    case = record(rng)
    images = case.scan.images.copy()
    images[5] = rng.normal(50_000, 20_000, images[5].shape)
    found = coarse_alignment(ScanImages.whole(PAPER, ORDERS_24, images))
    assert found.without_pattern == (5,)


@pytest.mark.parametrize("value", [0.0, 20_000.0, 65_535.0])
def test_a_frame_without_contrast_is_left_out(value: float) -> None:
    images = record(default_rng(), scan=SMALL, grating=ORDERS_12).scan.images.copy()
    images[4] = value
    assert coarse_alignment(ScanImages.whole(SMALL, ORDERS_12, images)).without_pattern == (4,)


def test_noise_that_resembles_the_pattern_by_chance_is_too_weak_for_it() -> None:
    rng = default_rng()
    images = record(rng, scan=SMALL, grating=ORDERS_12).scan.images.copy()
    for std in np.geomspace(10, 10_000, 30):
        images[4] = rng.normal(50_000, std, images[4].shape)
        assert coarse_alignment(ScanImages.whole(SMALL, ORDERS_12, images)).without_pattern == (4,)


def test_a_frame_of_a_third_of_the_light_still_counts() -> None:
    images = record(default_rng(), scan=SMALL, grating=ORDERS_12).scan.images.copy()
    images[4] /= 3
    assert coarse_alignment(ScanImages.whole(SMALL, ORDERS_12, images)).without_pattern == ()


@pytest.mark.parametrize("value", [0.0, 20_000.0])
def test_frames_without_any_contrast_are_refused(value: float) -> None:
    with pytest.raises(NotDeterminedError) as refused:
        coarse_alignment(ScanImages.whole(SMALL, ORDERS_12, np.full((10, 30, 30), value)))
    assert refused.value.code == "no-pattern"


@pytest.mark.parametrize("other", [Grating(650, 330.0), Grating(325, 500.0)])
def test_another_grating_s_pattern_is_not_taken_for_this_one_s(other: Grating) -> None:
    images = record(default_rng(), (96, 96), grating=other).scan.images
    with pytest.raises(NotDeterminedError, match="do not show the pattern") as refused:
        coarse_alignment(ScanImages.whole(PAPER, ORDERS_24, images))
    assert refused.value.code == "no-pattern"
