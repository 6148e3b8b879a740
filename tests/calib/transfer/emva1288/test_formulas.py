"""Each formula against the standard's own words, written out plainly."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import convolve, uniform_filter

from calib.recording.header import Block
from calib.recording.statistics import never
from calib.transfer.emva1288.block_figures import BlockFigures, figures_of
from calib.transfer.emva1288.block_image import BlockImage, read_block
from calib.transfer.emva1288.defects import BINS, histogram_of
from calib.transfer.emva1288.formulas import relative_line
from calib.transfer.emva1288.highpass import ACROSS, ALONG, REACH, highpass
from calib.transfer.emva1288.nonuniformity import components, mean_squares
from calib.transfer.emva1288.propagation import propagate
from calib.transfer.emva1288.spatial_curves import curves_of
from tests.calib.transfer.emva1288.drawn_camera import DrawnCamera


def image(camera: DrawnCamera, frames: int, seed: int = 1) -> tuple[BlockImage, NDArray[np.uint16]]:
    block = Block(block="000", kind="flat", exposure_us=10.0, level=1.0, lines=frames)
    recording = camera.record([block], np.random.default_rng(seed))
    return read_block(recording, block, None, never), recording.stretches["000"][0]


def pair_variance(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Eq. 18, and the factor that its own mean takes of the pixels."""
    plain = np.mean((a - b) ** 2) / 2 - (a.mean() - b.mean()) ** 2 / 2
    return float(plain * a.size / (a.size - 1))


@pytest.mark.parametrize("frames", [2, 5])
def test_the_temporal_variance_is_eq_18_averaged_over_all_pairs(frames: int) -> None:
    reduced, codes = image(DrawnCamera(rows=20, columns=30, line_noise_dn=1.0), frames)
    y = codes.astype(np.float64)
    pairs = [pair_variance(y[i], y[j]) for i in range(frames) for j in range(i)]
    assert figures_of(reduced).variance_dn2 == pytest.approx(np.mean(pairs), rel=1e-12)


def test_a_flash_of_the_whole_frame_is_no_temporal_noise() -> None:
    reduced, codes = image(DrawnCamera(rows=20, columns=30), 2)
    steady = figures_of(reduced)
    codes[1] += 7
    flashed = figures_of(_reduced(codes))
    assert flashed.variance_dn2 == pytest.approx(steady.variance_dn2, rel=1e-9)
    assert flashed.mean_dn == pytest.approx(steady.mean_dn + 3.5, rel=1e-12)
    first, second = codes.mean(axis=(1, 2))
    assert flashed.mean_dn_std == pytest.approx(abs(second - first) / 2, rel=1e-9)
    assert steady.mean_dn_std < 0.5


def _reduced(codes: NDArray[np.uint16]) -> BlockImage:
    y = codes.astype(np.float64)
    rows = y.mean(axis=2)
    return BlockImage(
        Block(block="000", kind="flat", exposure_us=10.0), len(y), y.mean(axis=0),
        y.var(axis=0, ddof=1), float(rows.var(axis=0, ddof=1).mean()),
        float(rows.mean(axis=1).var(ddof=1)), 0.0, 0.0,
    )  # fmt: skip


def test_a_lines_common_noise_is_a_line_sensors_own() -> None:
    _, codes = image(DrawnCamera(rows=None, columns=64, line_noise_dn=3.0), 50)
    reduced, _ = image(DrawnCamera(rows=None, columns=64, line_noise_dn=3.0), 50)
    y = codes.astype(np.float64)
    expected = float(y.var(axis=0, ddof=1).mean())
    assert figures_of(reduced).variance_dn2 == pytest.approx(expected, rel=1e-12)


def test_one_pass_in_stretches_is_the_same() -> None:
    camera = DrawnCamera(rows=12, columns=16, line_noise_dn=1.0)
    block = Block(block="000", kind="flat", exposure_us=10.0, level=1.0, lines=9)
    recording = camera.record([block], np.random.default_rng(4))
    whole = read_block(recording, block, None, never)
    (codes,) = recording.stretches["000"]
    recording.stretches["000"] = (codes[:2], codes[2:3], codes[3:])
    parts = read_block(recording, block, None, never)
    assert parts.row_variance_dn2 == pytest.approx(whole.row_variance_dn2, rel=1e-12)
    assert parts.frame_variance_dn2 == pytest.approx(whole.frame_variance_dn2, rel=1e-12)
    np.testing.assert_array_equal(parts.variance_dn2, whole.variance_dn2)
    rows = codes.astype(np.float64).mean(axis=2)
    assert whole.row_variance_dn2 == pytest.approx(rows.var(axis=0, ddof=1).mean(), rel=1e-10)


def test_the_relative_line_is_that_of_eqs_59_to_61() -> None:
    rng = np.random.default_rng(2)
    h = np.linspace(1.0, 9.0, 12)
    y = 3.0 + 40.0 * h + rng.normal(0.0, 5.0, 12)
    s_hy, s_hy2, s_h2y2 = np.sum(h / y), np.sum(h / y**2), np.sum(h**2 / y**2)
    s_1y, s_1y2 = np.sum(1 / y), np.sum(1 / y**2)
    delta = s_hy2**2 - s_h2y2 * s_1y2
    offset, slope = relative_line(h, y)
    assert offset == pytest.approx((s_hy * s_hy2 - s_h2y2 * s_1y) / delta, rel=1e-9)
    assert slope == pytest.approx((s_hy2 * s_1y - s_hy * s_1y2) / delta, rel=1e-9)


def test_the_lowpass_is_two_boxes_and_a_binomial() -> None:
    drawn = np.random.default_rng(3).normal(0.0, 1.0, (60, 70))
    low = uniform_filter(uniform_filter(drawn, 7), 11)
    low = convolve(low, np.outer([1, 2, 1], [1, 2, 1]) / 16)
    inner = slice(REACH, -REACH)
    np.testing.assert_allclose(highpass(drawn), (drawn - low)[inner, inner], atol=1e-12)


def test_slow_light_does_not_pass_the_filter() -> None:
    x, y = np.meshgrid(np.arange(60.0), np.arange(50.0))
    np.testing.assert_allclose(highpass(100.0 + 3.0 * x - 2.0 * y), 0.0, atol=1e-9)


def test_what_the_filter_leaves_of_white_patterns_is_as_stated() -> None:
    rng = np.random.default_rng(5)
    pixels = np.array([np.mean(highpass(rng.normal(0, 1, (300, 300))) ** 2) for _ in range(20)])
    lines = np.array([np.mean(highpass(rng.normal(0, 1, (1, 4000))) ** 2) for _ in range(100)])
    for drawn, loss, n in ((pixels, ACROSS, 282**2), (lines, ALONG, 3982)):
        expected_std = loss.power * np.sqrt(2 * loss.spread / n)
        assert abs(drawn.mean() - loss.power) < 4 * expected_std / np.sqrt(len(drawn))
        assert drawn.std(ddof=1) == pytest.approx(
            expected_std, rel=4 / np.sqrt(2 * (len(drawn) - 1))
        )


@pytest.mark.parametrize("filtered", [True, False])
def test_row_column_and_pixel_variances_are_free_of_bias(filtered: bool) -> None:
    rng = np.random.default_rng(6)
    true = {"row": 0.5, "column": 2.0, "pixel": 4.0, "total": 6.5}
    noise = 9.0  # of a frame; what four leave of it is more than any pattern of rows
    figures = BlockFigures(
        Block(block="0", kind="dark", exposure_us=1.0), 4, *(0.0,) * 4, noise, 0.0, 0.0, 0.0
    )
    found: dict[str, list[float]] = {name: [] for name in true}
    for _ in range(200):
        drawn = rng.normal(0, np.sqrt(true["pixel"] + noise / 4), (44, 60))
        drawn += rng.normal(0, np.sqrt(true["row"]), (44, 1))
        drawn += rng.normal(0, np.sqrt(true["column"]), (1, 60))
        squares = mean_squares(drawn, figures, filtered=filtered)
        for name, value in components(np.array(squares.values), squares.shape).items():
            found[name].append(float(value))
    for name, values in found.items():
        error = np.std(values, ddof=1) / np.sqrt(len(values))
        assert abs(np.mean(values) - true[name]) < 4 * error, name


def test_shared_inputs_move_together() -> None:
    def ratio(batch: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        x, y = batch[:, 0], batch[:, 1]
        return {"ratio": x / y, "one": x / x, "sum": x + y}

    found = propagate(ratio, np.array([6.0, 3.0]), np.array([0.6, 0.3]))
    assert found["ratio"] == pytest.approx((2.0, 2.0 * np.hypot(0.1, 0.1)), rel=1e-3)
    assert found["one"] == (1.0, 0.0)
    assert found["sum"] == pytest.approx((9.0, np.hypot(0.6, 0.3)), rel=1e-6)


@pytest.mark.parametrize("grain", [0.0, 1 / 16])
def test_histograms_lose_no_pixel(grain: float) -> None:
    rng = np.random.default_rng(7)
    drawn = rng.normal(100.0, 2.0, (40, 50))
    drawn[3, 4] = 160.0
    if grain:
        drawn = np.round(drawn / grain) * grain
    found = histogram_of(drawn, grain)
    assert found.count.sum() == drawn.size
    assert len(found.count) <= BINS
    # Each pixel lies within half a bin of its bin's middle.
    width = float(np.diff(found.deviation)[0])
    mean = float(np.sum(found.deviation * found.count)) / drawn.size
    assert abs(mean) <= width / 2
    assert found.deviation[-1] == pytest.approx(160.0 - drawn.mean(), abs=width / 2 + 1e-9)
    assert found.share_beyond[0] == 1.0
    assert found.share_beyond[-1] == pytest.approx(1 / drawn.size)
    assert np.all(np.diff(found.share_beyond) <= 0)


def test_a_spectrogram_keeps_the_variance_and_finds_a_tone() -> None:
    rng = np.random.default_rng(8)
    flat = 2000.0 + rng.normal(0.0, 10.0, (64, 96)) + 15.0 * np.cos(np.pi / 4 * np.arange(96))
    quiet = BlockFigures(Block(block="0", kind="flat", exposure_us=1.0), 4, *(0.0,) * 8)
    image_curves = curves_of(np.zeros((64, 96)), flat, quiet, quiet).flat
    power, frequency = image_curves.across.power, image_curves.across.per_pixel
    twice = np.where((frequency > 0) & (frequency < 0.5), 2.0, 1.0)
    percent = 100 * flat / flat.mean()
    assert np.sum(twice * power) / 96 == pytest.approx(np.var(percent), rel=1e-9)
    assert frequency[1:][np.argmax(power[1:])] == pytest.approx(1 / 8)
    assert np.argmax(image_curves.horizontal.mean) % 8 in {0, 1, 7}
