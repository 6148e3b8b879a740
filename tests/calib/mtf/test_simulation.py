"""The simulated images are exact: they are compared with sums and integrals done otherwise."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.errors import InputError
from calib.mtf.geometry import Alignment, Sampling, Scan
from calib.mtf.grating.pattern import intensity
from calib.mtf.simulation.bench import Bench
from calib.mtf.simulation.crosstalk import NeighbourCrosstalk
from calib.mtf.simulation.detector import DetectorNoise
from calib.mtf.simulation.response import PixelResponse, centred
from calib.mtf.simulation.sampled import Sampled
from calib.mtf.simulation.shapes import Shape, l_shape, shamrock, square, truncated_corner
from tests.calib.mtf.simulated import CORNER, ORDERS_12, SMALL

SHAPES = [
    square(20.0, 3.0),
    truncated_corner(25.0, 10.0, 0.2, 2.5),
    l_shape(24.0, 8.0, 2.0),
    shamrock(20.0, 0.08, 4.0, 2.0),
]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_transfer_function_is_the_fourier_transform_of_the_density(shape: Shape) -> None:
    # The trapezoidal rule is exact to exp(-(2π·2/0.5)²/2) for densities as smooth as these.
    axis = np.arange(-60.0, 60.0, 0.5)
    x, y = np.meshgrid(axis, axis)
    density = shape.density(x, y)
    assert density.sum() * 0.25 == pytest.approx(1.0, abs=1e-9)
    for fx, fy in default_rng().uniform(-0.12, 0.12, (5, 2)):
        numeric = (density * np.exp(-2j * np.pi * (fx * x + fy * y))).sum() * 0.25
        exact = centred(shape, np.array([fx]), np.array([fy]))[0]
        assert abs(exact - numeric) < 1e-9


def test_a_sampled_response_has_the_transfer_function_of_its_staircase() -> None:
    stairs = Sampled(np.ones((10, 10)), 2.0)
    fx, fy = default_rng().uniform(-0.2, 0.2, (2, 20))
    np.testing.assert_allclose(stairs.transfer(fx, fy), square(20.0).transfer(fx, fy), atol=1e-12)
    lopsided = Sampled(np.array([[1.0, 0.0, 3.0]]), 2.0)
    assert lopsided.centroid_um == (1.0, 0.0)


def test_crosstalk_is_the_neighbours_signal_in_one_s_own() -> None:
    pixel = Bench(SMALL, ORDERS_12, CORNER, (12, 12)).light()
    mixed = Bench(
        SMALL, ORDERS_12, NeighbourCrosstalk(CORNER, SMALL.pitch_um, 0.02, 0.005), (12, 12)
    ).light()
    inner = pixel[:, 1:-1, 1:-1]
    beside = pixel[:, :-2, 1:-1] + pixel[:, 2:, 1:-1] + pixel[:, 1:-1, :-2] + pixel[:, 1:-1, 2:]
    corner = pixel[:, :-2, :-2] + pixel[:, 2:, :-2] + pixel[:, :-2, 2:] + pixel[:, 2:, 2:]
    expected = 0.9 * inner + 0.02 * beside + 0.005 * corner
    np.testing.assert_allclose(mixed[:, 1:-1, 1:-1], expected, atol=1e-12)


def test_pixels_sample_where_the_contract_says() -> None:
    sampling = Sampling.whole(Scan(25.0, 1, 6), (9, 11))
    step = 25.0 / np.sqrt(37)
    for position, (x, y) in enumerate(sampling.positions_um()):
        for row, column in ((0, 0), (8, 3), (5, 10)):
            assert x[row, column] == pytest.approx(step * (column * 6 - row + position))
            assert y[row, column] == pytest.approx(step * (column + row * 6))


def test_all_positions_together_fill_the_oversampled_grid_once() -> None:
    scan = Scan(25.0, 2, 3)
    seen = set()
    for x, y in Sampling.whole(scan, (30, 30)).positions_um():
        points = np.stack([x, y], -1).reshape(-1, 2) / scan.step_um
        seen |= {tuple(each) for each in points.round().astype(int).tolist()}
    assert len(seen) == scan.positions * 30 * 30
    assert all((i, j) in seen for i in range(-10, 11) for j in range(70, 80))


def test_a_pixel_s_value_is_the_pattern_s_integral_over_it() -> None:
    tilt = np.radians(1.3)
    alignment = Alignment(np.array([3.0, -7.0]), 0.0, tilt)
    bench = Bench(SMALL, ORDERS_12, square(20.0), (4, 5), alignment)
    light = bench.light()
    inside = (np.arange(200) + 0.5) / 200 * 20.0 - 10.0  # midpoints: error below 1e-4 of a fringe
    u, v = np.meshgrid(inside, inside)
    angle = SMALL.tilt_rad + tilt
    for position, (x, y) in enumerate(bench.sampling.positions_um()):
        px = x[2, 3] + np.cos(angle) * u - np.sin(angle) * v
        py = y[2, 3] + np.sin(angle) * u + np.cos(angle) * v
        mean = intensity(ORDERS_12.harmonics, px.ravel(), py.ravel()).mean()
        assert light[position, 2, 3] == pytest.approx(mean, abs=2e-4)
        if position == 2:
            break


@pytest.mark.parametrize("response", [CORNER, square(20.0)])
def test_every_error_of_the_bench_moves_the_points_and_nothing_else(
    response: PixelResponse,
) -> None:
    rng = default_rng()
    alignment = Alignment(
        rng.uniform(-9, 9, 2), 1e-3, 2e-3, rng.normal(scale=0.2, size=(SMALL.positions, 2))
    )
    bench = Bench(SMALL, ORDERS_12, response, (6, 7), alignment)
    harmonics = ORDERS_12.harmonics
    transfer = response.transfer(*bench.sampling.to_detector(harmonics.frequency_per_um).T)
    for image, (x, y) in zip(bench.light(), bench.sampling.positions_um(), strict=True):
        np.testing.assert_allclose(image, intensity(harmonics, x, y, transfer), atol=1e-11)


def test_vibration_blurs_along_its_direction() -> None:
    still = Bench(SMALL, ORDERS_12, CORNER, (8, 8)).light()
    shaken = Bench(SMALL, ORDERS_12, CORNER, (8, 8), vibration_um=(5.0, 0.0)).light()
    moved = sum(
        w * Bench(SMALL, ORDERS_12, CORNER, (8, 8), Alignment(np.array([x, 0.0]))).light()
        for x, w in zip(*_gauss_hermite(5.0), strict=True)
    )
    np.testing.assert_allclose(shaken, moved, atol=1e-9)
    assert np.abs(shaken - still).max() > 0.05


def _gauss_hermite(sigma: float) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.hermite.hermgauss(24)
    return np.sqrt(2) * sigma * nodes, weights / np.sqrt(np.pi)


def test_noise_has_the_variance_that_electrons_have() -> None:
    rng = default_rng()
    noise = DetectorNoise(mean_e=1e4, read_noise_e=50.0, shot_noise=True, averaged=20)
    light = np.full((400, 400), 1.7)
    drawn = noise.record(light, np.ones_like(light), np.zeros_like(light), rng)
    expected = (1.7e4 + 2500) / 20
    standard_error = expected * np.sqrt(2 / light.size)
    assert abs(drawn.var() - expected) < 5 * standard_error
    assert abs(drawn.mean() - 1.7e4) < 5 * np.sqrt(expected / light.size)


@pytest.mark.parametrize(
    "wrong", [{"mean_e": 0.0}, {"averaged": 0}, {"gain_std": -0.1}, {"read_noise_e": -1.0}]
)
def test_a_detector_that_cannot_be_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError) as refused:
        DetectorNoise(**wrong)  # type: ignore[arg-type]
    assert refused.value.code == "bad-detector"
