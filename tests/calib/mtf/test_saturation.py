"""Clipped spots are told from rounded ones, whatever dark image was subtracted."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.errors import NotDeterminedError
from calib.mtf.assembly.odd_pixels import plausible_pixels
from calib.mtf.assembly.saturation import check_saturation, saturated_pixels
from calib.mtf.geometry import Scan
from calib.mtf.grating.grating import Grating
from calib.mtf.measure import measure
from calib.mtf.scan_images import ScanImages
from tests.calib.mtf.simulated import ORDERS_12, ORDERS_24, PAPER, SMALL, record

SCANS = [pytest.param(SMALL, ORDERS_12, id="10"), pytest.param(PAPER, ORDERS_24, id="37")]

BY_ROUNDING = 0.02
"""Share of pixels that rounding to 8 bits makes equal at their top: taken along with clipped."""


def codes(
    scan: Scan, grating: Grating, bits: int, noise_dn: float = 0.5, size: int = 96
) -> NDArray[np.floating]:
    """Images that use nine tenths of a converter's range, in DN, rounded."""
    rng = default_rng()
    light = record(rng, (size, size), scan=scan, grating=grating).bench.light()
    signal = 0.9 * 2**bits * light / light.max()
    rounded: NDArray[np.floating] = np.round(signal + noise_dn * rng.normal(size=light.shape))
    return rounded


@pytest.mark.parametrize(("scan", "grating"), SCANS)
@pytest.mark.parametrize("bits", [5, 8, 12])
def test_rounding_is_not_taken_for_saturation(scan: Scan, grating: Grating, bits: int) -> None:
    for noise_dn in (0.1, 2.0):
        images = codes(scan, grating, bits, noise_dn)
        images[:, 5, 7], images[:, 60, 3] = 0, 4095
        assert not saturated_pixels(images).any()


@pytest.mark.parametrize(("scan", "grating"), SCANS)
@pytest.mark.parametrize("bits", [8, 12])
def test_clipped_spots_are_found_where_they_are(scan: Scan, grating: Grating, bits: int) -> None:
    images = codes(scan, grating, bits)
    full = np.floor(0.6 * images.max())
    found, true = saturated_pixels(np.minimum(images, full)), (images >= full).any(axis=0)
    np.testing.assert_array_equal(found & true, true)
    assert (found & ~true).mean() < BY_ROUNDING


@pytest.mark.parametrize(("scan", "grating"), SCANS)
def test_they_are_found_below_a_dark_image_that_was_subtracted(
    scan: Scan, grating: Grating
) -> None:
    images = codes(scan, grating, 12)
    full = np.floor(0.6 * images.max())
    dark = default_rng().normal(40, 5, images.shape[1:])
    found, true = saturated_pixels(np.minimum(images, full) - dark), (images >= full).any(axis=0)
    assert found.sum() > 0.3 * true.sum()  # those that two frames or more clip
    assert (found & ~true).mean() < BY_ROUNDING


def test_a_scan_of_clipped_spots_is_refused_and_a_few_pixels_are_left_out() -> None:
    images = codes(SMALL, ORDERS_12, 12, size=160)
    with pytest.raises(NotDeterminedError, match="less light") as refused:
        measure(ScanImages.whole(SMALL, ORDERS_12, np.minimum(images, 0.7 * images.max())))
    assert refused.value.code == "saturated"
    highest = np.sort(images.max(axis=0).ravel())
    few = np.minimum(images, highest[-40])  # of 25,600
    check_saturation(few)
    assert 40 <= (~plausible_pixels(few)).sum() < 60
