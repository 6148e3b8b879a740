"""S3NUC and SANUC pixel by pixel: their equations, their errors, their states."""

from collections.abc import Callable

import numpy as np
import pytest

from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps
from calib.transfer.two_exposures.pixel_state import PixelState
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sampling import sampling_covariance
from calib.transfer.two_exposures.sanuc import sanuc
from tests.calib.transfer.two_exposures.scores import mean_of, spread_of
from tests.calib.transfer.two_exposures.stacks import (
    Sensor,
    Values,
    accumulated,
    drawn_pair,
    pair_of,
)

N_PIXELS = 6000
SEVERAL = 4.0  # standard errors


def exact(n_frames: int, ratio: float = 2.0) -> ExposurePair:
    """The true moments of two pixels, as if n frames had given them."""
    gain, bias = np.array([0.5, 2.0]), np.array([100.0, 50.0])
    electrons, read = np.array([400.0, 900.0]), np.array([9.0, 25.0])
    none = np.zeros(2, np.uint32)

    def moments(k: Values) -> ExposureMoments:
        variance = gain**2 * k + read + 1 / 12
        of = (gain * k + bias, variance, gain**3 * k)
        return ExposureMoments(n_frames, n_frames - 1, *of, none, none)

    return ExposurePair(moments(electrons), moments(ratio * electrons), ratio)


@pytest.mark.parametrize("ratio", [2.0, 1.98, 3.0])
def test_true_moments_give_the_true_parameters(ratio: float) -> None:
    for maps in (sanuc(exact(10**12, ratio)), s3nuc(exact(10**12, ratio))):
        assert np.allclose(maps.system_gain_dn_per_e, [0.5, 2.0], rtol=1e-9)
        assert np.allclose(maps.bias_dn, [100.0, 50.0], rtol=1e-6)
        assert np.allclose(maps.photoelectrons, [400.0, 900.0], rtol=1e-6)
        assert np.allclose(maps.photoelectrons_step, (ratio - 1) * np.array([400.0, 900.0]), 1e-6)
        assert np.allclose(maps.read_noise_variance_dn2, [9.0, 25.0], rtol=1e-5)
        assert maps.valid.all()


def test_an_error_of_the_ratio_enters_what_it_bends_and_nothing_else() -> None:
    pair = exact(10**12)
    sure = sanuc(pair)
    unsure = sanuc(ExposurePair(pair.first, pair.second, 2.0, ratio_std=1e-3))
    moved = sanuc(ExposurePair(pair.first, pair.second, 2.0 + 1e-3))
    for name in ("bias_dn", "photoelectrons", "read_noise_variance_dn2"):
        shift = np.abs(getattr(moved, name) - getattr(sure, name))
        assert np.allclose(getattr(unsure, name + "_std"), shift, rtol=0.01), name
    assert np.array_equal(unsure.system_gain_dn_per_e_std, sure.system_gain_dn_per_e_std)


@pytest.mark.parametrize("n_frames", [100, 500])
@pytest.mark.parametrize(
    ("electrons", "read_e", "gain"), [(10_000.0, 10.0, 1.0), (2000.0, 4.0, 0.4)]
)
def test_sanuc_covers_pixel_by_pixel(
    n_frames: int, electrons: float, read_e: float, gain: float
) -> None:
    sensor = Sensor.flat(N_PIXELS, electrons, read_e, gain, spread=0.05)
    maps = sanuc(drawn_pair(sensor, n_frames, key=n_frames))
    z_of = {
        "system_gain_dn_per_e": sensor.gain,
        "bias_dn": sensor.bias,
        "photoelectrons": sensor.electrons,
        "read_noise_variance_dn2": sensor.read_noise_dn2,
    }
    # V and its uncertainty come from the same variances: z leans by their correlation, and 1/V
    # by twice the relative error of V.
    tied = 7 / 5**1.5 * np.sqrt(2.0 / n_frames)
    relative = np.sqrt(10.0 / (n_frames - 1))
    lean = {"system_gain_dn_per_e": tied, "photoelectrons": 2 * relative}
    for name, true in z_of.items():
        value, std = getattr(maps, name), getattr(maps, name + "_std")
        known = np.isfinite(value)
        z = (value - true)[known] / std[known]
        spread, of_spread = spread_of(z)
        assert abs(spread - 1.0) < 0.1 + SEVERAL * of_spread, name
        mean, of_mean = mean_of(z)
        assert abs(mean) < lean.get(name, 0.0) + SEVERAL * of_mean, name
    assert np.isfinite(maps.photoelectrons).mean() > 0.97


@pytest.mark.parametrize("n_frames", [100, 500])
def test_the_bias_of_the_ratio_is_undone(n_frames: int) -> None:
    sensor = Sensor.flat(N_PIXELS, 10_000.0, 10.0)
    pair = drawn_pair(sensor, n_frames, key=7)
    electrons = sanuc(pair).photoelectrons
    known = np.isfinite(electrons)
    plain = pair.difference_dn**2 / pair.variance_difference_dn2
    relative2 = 10.0 / (n_frames - 1)
    error = np.sqrt(relative2 / known.sum())
    # As printed the mean is too high by the squared relative error of V, and by its tails.
    assert plain[known].mean() / 1e4 - 1.0 > 0.8 * relative2 - SEVERAL * error
    # What is left is of fourth order, and what is left out as undecidable.
    left = 2.0 * relative2**2 + (1.0 - known.mean()) * 2.0
    assert abs(electrons[known].mean() / 1e4 - 1.0) < left + SEVERAL * error


def test_the_reciprocal_of_the_photoelectrons_is_not_skewed() -> None:
    sensor = Sensor.flat(N_PIXELS, 10_000.0, 10.0)
    pair = drawn_pair(sensor, 100, key=11)
    maps = sanuc(pair)
    d, v = pair.difference_dn, pair.variance_difference_dn2
    known = np.isfinite(maps.photoelectrons)
    relative = maps.photoelectrons_std[known] / (d**2 / v)[known]
    z = (v / d**2 - 1e-4)[known] / (relative * (v / d**2)[known])
    mean, of_mean = mean_of(z)
    tied = 7 / 5**1.5 * np.sqrt(2.0 / 100)
    cut = 0.03  # of those left out at V < u(V)
    assert abs(mean) < tied + cut + SEVERAL * of_mean


@pytest.mark.parametrize("n_frames", [1000, 10_000])
def test_s3nuc_undoes_the_bias_of_second_order(n_frames: int) -> None:
    # E f(x) = f + tr(H C)/2 with the Hessian H by differences, against what is divided by.
    pair = exact(n_frames)
    maps = s3nuc(pair)
    told = {
        3: maps.photoelectrons,
        2: pair.first.mean_dn - maps.bias_dn,
        1: pair.first.variance_dn2 - 1 / 12 - maps.read_noise_variance_dn2,
    }
    gain = np.array([0.5, 2.0])
    for pixel in range(2):
        some = pair.at(slice(pixel, pixel + 1))
        a, b = some.first, some.second
        q, g = some.difference_dn, gain[pixel]
        one = sampling_covariance(a, q, g)
        two = sampling_covariance(b, 2 * q, g)
        c = np.zeros((5, 5))
        c[0, 0], c[1, 1], c[2, 2] = one.mean[0], one.variance[0], one.third[0]
        c[0, 1] = c[1, 0] = one.mean_variance[0]
        c[0, 2] = c[2, 0] = one.mean_third[0]
        c[1, 2] = c[2, 1] = one.variance_third[0]
        c[3, 3], c[4, 4] = two.mean[0], two.variance[0]
        c[3, 4] = c[4, 3] = two.mean_variance[0]
        for power, values in told.items():

            def f(x: Values, power: int = power) -> float:
                return float(x[2] * ((x[3] - x[0]) / (x[4] - x[1])) ** power)

            moments = (a.mean_dn, a.variance_dn2, a.third_dn3, b.mean_dn, b.variance_dn2)
            x = np.concatenate(moments)
            bias = 0.5 * np.sum(hessian(f, x) * c) / f(x)
            assert bias > 0.001
            assert f(x) / values[pixel] - 1.0 == pytest.approx(bias, rel=0.02), power


def hessian(f: Callable[[Values], float], x: Values) -> Values:
    steps = np.diag(1e-4 * np.abs(x))
    second = np.zeros((x.size, x.size))
    for i, a in enumerate(steps):
        for j, b in enumerate(steps):
            rise = f(x + a + b) - f(x + a - b) - f(x - a + b) + f(x - a - b)
            second[i, j] = rise / (4 * a[i] * b[j])
    return second


def test_blocks_merge_about_their_own_means() -> None:
    rng = np.random.default_rng(3)
    parts = [rng.integers(0, 50 + 20 * k, (n, 7)).astype(np.uint16) for k, n in enumerate((5, 9))]
    one, two = (ExposureMoments.of(accumulated(dn).sums) for dn in parts)
    merged = one.merged(two)
    deviations = np.concatenate([dn - dn.mean(axis=0) for dn in parts])
    assert (merged.n_frames, merged.n_free) == (14, 12)
    assert np.allclose(merged.mean_dn, np.concatenate(parts).mean(axis=0), rtol=1e-12)
    assert np.allclose(merged.variance_dn2, (deviations**2).sum(axis=0) / 12, rtol=1e-12)
    third = (5 * one.third_dn3 + 9 * two.third_dn3) / 14
    assert np.allclose(merged.third_dn3, third, rtol=1e-12)


def test_s3nuc_covers_where_third_moments_are_known() -> None:
    # 6 K of frames and more: 20 e⁻, 4,000 frames.
    sensor = Sensor.flat(3000, 20.0, 1.0)
    maps = s3nuc(drawn_pair(sensor, 4000, key=3))
    true = {
        "system_gain_dn_per_e": 1.0,
        "bias_dn": sensor.bias,
        "photoelectrons": 20.0,
        "photoelectrons_step": 20.0,
        "read_noise_variance_dn2": 1.0,
    }
    for name, value in true.items():
        std = getattr(maps, name + "_std")
        z = (getattr(maps, name) - value) / std
        spread, of_spread = spread_of(z)
        assert abs(spread - 1.0) < 0.03 + SEVERAL * of_spread, name
        # Of second order in the relative error of T, 0.17, and of G.
        assert abs(z.mean()) < 0.25, name


@pytest.mark.parametrize("method", [sanuc, s3nuc])
def test_gain_and_bias_go_together_as_stated(
    method: Callable[[ExposurePair], PixelMaps],
) -> None:
    sensor = Sensor.flat(3000, 20.0, 1.0)
    flat = Sensor(sensor.gain, np.full(3000, 100.0), sensor.electrons, 1.0)
    maps = method(drawn_pair(flat, 3000, key=5))
    g, b = maps.system_gain_dn_per_e, maps.bias_dn
    product = (g - g.mean()) * (b - b.mean())
    error = product.std() / np.sqrt(product.size)
    assert abs(product.mean() - np.median(maps.gain_bias_covariance)) < SEVERAL * error


def test_rounding_is_not_counted_as_read_noise() -> None:
    # Half a DN of read noise beside 0.29 DN of rounding; Sheppard's correction holds from there.
    sensor = Sensor.flat(N_PIXELS, 1.0, 0.5)
    maps = sanuc(drawn_pair(sensor, 400, key=2))
    mean, error = mean_of(maps.read_noise_variance_dn2)
    assert abs(mean - 0.25) < SEVERAL * error
    assert error < 1 / 12 / 3 / SEVERAL  # it would be seen


def test_a_pixel_that_cannot_be_decided_says_why() -> None:
    sensor = Sensor.flat(64, 500.0, 5.0)
    one, two = sensor.frames(100, 1).copy(), sensor.frames(100, 2, 2.0).copy()
    two[3, 0] = 65535
    one[7, 1] = 0
    one[:, 2] = two[:, 2] = 77
    two[:, 3] = one[:, 3]
    two[:, 4] = one[:, 4] + 500
    maps = sanuc(pair_of(one, two))
    assert list(maps.reason[:5]) == [
        PixelState.CLIPPED_AT_FULL_SCALE,
        PixelState.CLIPPED_AT_ZERO,
        PixelState.DEAD,
        PixelState.NO_RESPONSE,
        PixelState.NO_SHOT_NOISE,
    ]
    names = ("system_gain_dn_per_e", "bias_dn", "photoelectrons", "read_noise_variance_dn2")
    told = [[bool(np.isfinite(getattr(maps, n)[k])) for n in names] for k in range(5)]
    nothing = [False] * 4
    assert told == [
        nothing,
        nothing,
        nothing,
        [False, True, False, True],
        [True, True, False, True],
    ]
    third = s3nuc(pair_of(one, two))
    assert np.isnan([getattr(third, n)[4] for n in names[1:]]).all()
    for each in (maps, third):
        unknown = np.isnan([getattr(each, name) for name in names]).any(axis=0)
        assert np.array_equal(unknown, each.reason != PixelState.VALID)


def test_negative_read_noise_variances_are_told_as_they_come_out() -> None:
    sensor = Sensor.flat(1000, 20_000.0, 2.0)
    maps = sanuc(drawn_pair(sensor, 50, key=9))
    share = np.mean(maps.read_noise_variance_dn2 < 0)
    assert abs(share - 0.5) < SEVERAL * 0.5 / np.sqrt(1000)


def test_the_moments_are_left_alone_and_parts_are_those_of_the_whole() -> None:
    sensor = Sensor.flat(500, 500.0, 5.0)
    pair = drawn_pair(sensor, 50, key=1)
    before = pair.first.variance_dn2.copy()
    maps = sanuc(pair)
    assert np.array_equal(pair.first.variance_dn2, before)
    part = pair.at(slice(100, 200))
    assert np.array_equal(sanuc(part).bias_dn, maps.bias_dn[100:200])
