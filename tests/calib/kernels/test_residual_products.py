import numpy as np
import pytest
from scipy.stats import norm

from calib.kernels.expected_histogram import code_chances, expected_histogram
from calib.kernels.residual_products import residual_products

NO_PARTNER = np.zeros((0, 12), np.intp)


def drawn(rows: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng()
    samples = rng.integers(90, 111, (9, rows, 12)).astype(np.uint16)
    return samples, samples.mean(axis=0)


@pytest.mark.parametrize("rows", [1, 3])
def test_sums_are_those_of_plain_numpy(rows: int) -> None:
    samples, mean = drawn(rows)
    tap = np.broadcast_to(np.arange(12) % 2, (rows, 12)).astype(np.intp)
    partner = np.where(np.arange(12) < 6, np.arange(12) + 6, -1)[None].astype(np.intp)
    sums = residual_products(samples, mean, np.full((rows, 12), 1e9), tap, 2, partner)
    residual = samples - mean
    of_tap = np.stack([residual[:, :, t::2].mean(axis=2) for t in (0, 1)], axis=2)
    residual = residual - np.take_along_axis(of_tap, np.broadcast_to(tap, (9, rows, 12)), axis=2)
    same = {"rtol": 1e-10, "atol": 1e-8}
    np.testing.assert_allclose(sums.line_means, of_tap, **same)
    np.testing.assert_allclose(sums.squares, (residual**2).sum(axis=0), **same)
    np.testing.assert_allclose(sums.fourths, (residual**4).sum(axis=0), **same)
    for k in (1, 2, 3, 4):
        products = (residual[:, :, :-k] * residual[:, :, k:]).sum(axis=0)
        np.testing.assert_allclose(sums.columns[k - 1, :, :-k], products, **same)
    for k in (1, 2):
        products = (residual[:-k] * residual[k:]).sum(axis=0)
        np.testing.assert_allclose(sums.lines[k - 1], products, **same)
    rowwise = (residual[:, :-1] * residual[:, 1:]).sum(axis=0)
    np.testing.assert_allclose(sums.rows[:-1], rowwise, **same)
    pairs = (residual[:, :, :6] * residual[:, :, 6:]).sum(axis=0)
    np.testing.assert_allclose(sums.partners[0, :, :6], pairs, **same)


def test_a_sample_far_off_counts_and_is_left_out() -> None:
    samples, mean = drawn(1)
    samples[4, 0, 7] = 1000
    tap = np.zeros((1, 12), np.intp)
    sums = residual_products(samples, mean, np.full((1, 12), 60.0), tap, 1, NO_PARTNER)
    assert sums.outliers.tolist() == [[0] * 7 + [1] + [0] * 4]
    assert sums.squares.max() < 60.0**2


def test_a_sample_a_thousand_times_the_noise_takes_no_other_with_it() -> None:
    samples, mean = drawn(1)
    samples[4, 0, 7] = 65_535
    tap = np.zeros((1, 12), np.intp)
    sums = residual_products(samples, mean, np.full((1, 12), 60.0), tap, 1, NO_PARTNER)
    assert sums.outliers.tolist() == [[0] * 7 + [1] + [0] * 4]
    others = np.delete(samples[4, 0] - mean[0], 7).mean()
    np.testing.assert_allclose(sums.line_means[4, 0, 0], others, rtol=1e-12)


@pytest.mark.parametrize("many", [1, 3, 4])
def test_samples_that_are_out_are_put_to_the_level_of_the_others(many: int) -> None:
    samples, mean = drawn(1)
    samples[4, 0, :many] += 120
    tap = np.zeros((1, 12), np.intp)
    sums = residual_products(samples, mean, np.full((1, 12), 60.0), tap, 1, NO_PARTNER)
    assert sums.outliers.tolist() == [[1] * many + [0] * (12 - many)]
    others = (samples[4, 0] - mean[0])[many:].mean()
    np.testing.assert_allclose(sums.line_means[4, 0, 0], others, rtol=1e-12)


def test_a_line_that_is_off_as_a_whole_is_no_outlier() -> None:
    samples, mean = drawn(1)
    samples[0] += 500
    tap = np.zeros((1, 12), np.intp)
    sums = residual_products(samples, mean, np.full((1, 12), 60.0), tap, 1, NO_PARTNER)
    assert sums.outliers.sum() == 0
    np.testing.assert_allclose(sums.line_means[0, 0, 0], (samples[0] - mean).mean(), rtol=1e-12)


def test_expected_histogram_is_that_of_rounded_and_clipped_gaussians() -> None:
    rng = np.random.default_rng()
    mean, std = rng.uniform(-1.0, 64.0, 50), rng.uniform(0.2, 6.0, 50)
    edges = np.concatenate([[-np.inf], np.arange(63) + 0.5, [np.inf]])
    twin = sum(7.0 * np.diff(norm.cdf(edges, m, s)) for m, s in zip(mean, std, strict=True))
    # Tails beyond 7 standard deviations are put into the next code, 3e-12 of all; the next term of
    # the series for wide noise, H8 / (92897280 s^8) of a density of 0.4 / s, is 0.9e-9 at 2 DN.
    np.testing.assert_allclose(expected_histogram(mean, std, 7.0, 64), twin, atol=350 * 1e-9)


@pytest.mark.parametrize("noise", [12.5, 40.0, 170.0])
def test_codes_between_which_wide_noise_is_interpolated_are_told_as_well(noise: float) -> None:
    rng = np.random.default_rng()
    mean, std = rng.uniform(-300.0, 4400.0, 50), noise * rng.uniform(1.0, 2.0, 50)
    edges = np.concatenate([[-np.inf], np.arange(4095) + 0.5, [np.inf]])
    twin = sum(7.0 * np.diff(norm.cdf(edges, m, s)) for m, s in zip(mean, std, strict=True))
    # Each of 50 pixels is off by 7e-8 of its density's height, 0.4 / noise, at the most.
    most = 350 * 0.4 / noise * 7e-8
    np.testing.assert_allclose(expected_histogram(mean, std, 7.0, 4096), twin, atol=most)


def test_the_chance_of_each_code_is_told_pixel_by_pixel() -> None:
    rng = np.random.default_rng()
    mean, std = rng.uniform(-1.0, 64.0, 50), rng.uniform(0.2, 6.0, 50)
    one_by_one = [
        expected_histogram(*each, 1.0, 64) for each in np.stack([mean, std], 1)[:, :, None]
    ]
    np.testing.assert_array_equal(code_chances(mean, std, 64), one_by_one)
