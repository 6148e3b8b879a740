import numpy as np

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.gather import block_sums
from calib.diagnosis.statistics.rare import RARE
from calib.diagnosis.statistics.repeats import repeated_in_blocks, repeated_lines
from calib.recording.header import CameraHeader

CAMERA = CameraHeader(columns=64, bit_depth=12)


def noise(n_lines: int, std: float) -> np.ndarray:
    rng = np.random.default_rng()
    return np.rint(rng.normal(100.0, std, (n_lines, 1, CAMERA.columns))).astype(np.uint16)


def test_lines_that_come_twice_are_counted_and_left_out_of_all_else() -> None:
    once = noise(50, 2.0)
    twice = np.repeat(once, np.where(np.isin(np.arange(50), (4, 20, 49)), 2, 1), axis=0)
    expected, found = (block_sums(lines, Sensor(CAMERA), 1 << 16) for lines in (once, twice))
    assert found.rare[RARE.index("identical_lines")] == 3
    assert found.n_lines == 50
    np.testing.assert_array_equal(found.products.lines, expected.products.lines)
    np.testing.assert_array_equal(found.histogram, expected.histogram)


def test_lines_that_are_alike_since_there_is_no_noise_are_kept() -> None:
    assert not repeated_lines(noise(50, 0.05)).any()
    assert not repeated_lines(noise(50, 2.0)).any()


def test_halves_of_lines_and_pairs_of_lines_are_found() -> None:
    half = noise(50, 2.0)
    half[21, :, 32:] = half[20, :, 32:]
    assert np.flatnonzero(repeated_lines(half)).tolist() == [21]
    pair = noise(50, 2.0)
    pair[30:32] = pair[28:30]
    assert np.flatnonzero(repeated_lines(pair)).tolist() == [30, 31]


def test_blocks_together_have_what_each_has_alone() -> None:
    blocks = np.stack([noise(50, 2.0) for _ in range(4)])
    blocks[1, 21, :, 32:] = blocks[1, 20, :, 32:]
    blocks[3, 31] = blocks[3, 29]
    # A few pixels that are alike by chance make no line of it.
    blocks[2, 8, :, :10] = blocks[2, 7, :, :10]
    found = repeated_in_blocks(blocks)
    assert [np.flatnonzero(each).tolist() for each in found] == [[], [21], [], [31]]
    np.testing.assert_array_equal(found, np.stack([repeated_lines(each) for each in blocks]))
