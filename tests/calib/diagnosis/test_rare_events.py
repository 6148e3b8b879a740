import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.evidence.rare_space import FIRST, RareSpace, whitened_counts
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.gather import block_sums
from calib.diagnosis.statistics.rare import RARE
from calib.recording.header import CameraHeader

CAMERA = CameraHeader(columns=64, bit_depth=12)


@pytest.mark.parametrize("mean", [4.0, 10.0, 40.0])
def test_counts_scatter_by_one_where_they_are_whitened(mean: float) -> None:
    n = 4000
    counts = default_rng().poisson(mean, n).astype(float)
    scatter = float(whitened_counts(counts).std())
    # The slope of the first event's part, 2 / (m + 1)^2, adds that times sqrt(m) to the scatter;
    # the scale bends, and twice as much covers what its curvature does.
    assert abs(scatter - 1.0) < 5.0 / np.sqrt(2 * n) + 2.0 * FIRST * np.sqrt(mean) / (mean + 1) ** 2


def test_the_derivative_of_counts_is_that_of_their_whitened_values() -> None:
    rng = default_rng()
    rates = 1e-4 * rng.random((6, len(RARE)))
    change = 1e-4 * rng.random((6, len(RARE)))
    space = RareSpace.of(
        np.zeros_like(rates), np.full(6, 80.0), 64, np.geomspace(1.0, 30.0, 6), np.zeros(6, bool)
    )
    step = 1e-6
    moved = (space.whitened(rates + step * change) - space.whitened(rates - step * change)) / 2
    np.testing.assert_allclose(moved / step, space.derivative(change, rates), rtol=1e-5, atol=1e-9)


def test_each_sample_that_stands_out_is_counted_once_and_for_what_it_is() -> None:
    lines = np.rint(default_rng().normal(300.0, 2.0, (80, 1, 64))).astype(np.int64)
    lines[10, 0, 5] = 320
    lines[20, 0, 9] = 278
    lines[30, 0, 20:22] = 400
    lines[40, 0, 40] = 428
    counted = block_sums(lines.astype(np.uint16), Sensor(CAMERA), 1 << 16)
    found = dict(zip(RARE, counted.rare.astype(int).tolist(), strict=True))
    expected = dict.fromkeys(RARE, 0)
    expected |= {"above": 1, "below": 1, "tracks": 2, "raised_7": 1}
    assert found == expected


def test_one_sample_far_out_leaves_its_pixels_others_as_they_are() -> None:
    lines = np.rint(default_rng().normal(300.0, 2.0, (80, 1, 64))).astype(np.uint16)
    hit = lines.copy()
    hit[33, 0, 12] = 3900
    quiet, found = (block_sums(x, Sensor(CAMERA), 1 << 16) for x in (lines, hit))
    off = found.products.squares[0, 12] / quiet.products.squares[0, 12] - 1.0
    # One sample of 80 is missing; the hit raised the mean by 22 standard deviations.
    assert abs(off) < 20.0 / 80.0
