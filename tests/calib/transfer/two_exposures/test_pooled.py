"""Pooled estimates: coverage at few and many frames, what biases sums, what frames share."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.random import Generator

from calib.transfer.two_exposures.propagation import propagate
from calib.transfer.two_exposures.sanuc import sanuc
from tests.calib.transfer.two_exposures.scores import mean_of, spread_of
from tests.calib.transfer.two_exposures.stacks import (
    RawLines,
    Sensor,
    Values,
    drawn_pair,
    pooled_of,
)

SEVERAL = 4.0  # standard errors
NAMES = ("system_gain_dn_per_e", "bias_dn", "photoelectrons", "read_noise_variance_dn2")
Draw = Callable[[Sensor, int, float, Generator], RawLines]


def plain(sensor: Sensor, n: int, light: float, rng: Generator) -> RawLines:
    return sensor.frames(n, int(rng.integers(1 << 62)), light)


def flickering(sensor: Sensor, n: int, light: float, rng: Generator) -> RawLines:
    """0.3 % from frame to frame: as much variance as 9 % of the shot noise of 10⁴ electrons."""
    return sensor.frames(n, int(rng.integers(1 << 62)), light * (1 + 0.003 * rng.normal(size=n)))


def jumping(sensor: Sensor, n: int, light: float, rng: Generator) -> RawLines:
    """Every frame has an offset of its own, 15 DN, in all pixels."""
    offsets = np.rint(15.0 * rng.normal(size=n)).astype(np.int64)
    return (plain(sensor, n, light, rng) + offsets[:, None]).astype(np.uint16)


def z_scores(sensor: Sensor, n: int, times: int, draw: Draw, seed: int) -> Values:
    """(times, 4), by NAMES."""
    rng = np.random.default_rng([seed, n])
    true = (sensor.gain, sensor.bias, sensor.electrons, sensor.read_noise_dn2)
    scores = []
    for _ in range(times):
        found = pooled_of(draw(sensor, n, 1.0, rng), draw(sensor, n, 2.0, rng))
        each = [getattr(found, name) for name in NAMES]
        scores.append([(e.value - t.mean()) / e.std for e, t in zip(each, true, strict=True)])
    return np.array(scores)


def assert_covered(z: Values, within: float = 0.1, lean: float = 0.0) -> None:
    for name, scores in zip(NAMES, z.T, strict=True):
        spread, of_spread = spread_of(scores)
        mean, of_mean = mean_of(scores)
        assert abs(spread - 1.0) < within + 2.0 * of_spread, f"{name}: spread {spread:.3f}"
        assert abs(mean) < lean + SEVERAL * of_mean, f"{name}: mean {mean:.3f} ± {of_mean:.3f}"


@pytest.mark.parametrize(("n_frames", "n_pixels"), [(20, 400), (100, 400), (500, 200)])
@pytest.mark.parametrize(("electrons", "read_e"), [(10_000.0, 10.0), (150.0, 6.0)])
def test_pooled_estimates_cover(
    n_frames: int, n_pixels: int, electrons: float, read_e: float
) -> None:
    sensor = Sensor.flat(n_pixels, electrons, read_e, gain=0.8, spread=0.02)
    assert_covered(z_scores(sensor, n_frames, 200, plain, seed=1))


@pytest.mark.soak
@pytest.mark.parametrize("seed", [11, 12, 13])
@pytest.mark.parametrize("n_frames", [20, 100, 500])
@pytest.mark.parametrize(("electrons", "read_e"), [(10_000.0, 10.0), (150.0, 6.0)])
@pytest.mark.parametrize("draw", [plain, flickering, jumping])
def test_pooled_estimates_cover_over_many_recordings(
    n_frames: int, electrons: float, read_e: float, seed: int, draw: Draw
) -> None:
    sensor = Sensor.flat(400, electrons, read_e, gain=0.8, spread=0.02)
    # Ratios go with their errors: z leans by up to twice the relative error, 4 % at 20 frames.
    assert_covered(z_scores(sensor, n_frames, 2000, draw, seed), lean=0.08)


@pytest.mark.parametrize("draw", [flickering, jumping])
@pytest.mark.parametrize("n_frames", [20, 100])
def test_what_frames_have_in_common_is_taken_off_and_in_the_error(
    n_frames: int, draw: Draw
) -> None:
    sensor = Sensor.flat(400, 10_000.0, 10.0)
    assert_covered(z_scores(sensor, n_frames, 150, draw, seed=2))


def test_what_frames_have_in_common_is_told() -> None:
    rng = np.random.default_rng(5)
    sensor = Sensor.flat(400, 10_000.0, 10.0)
    for draw, offset, flicker in ((flickering, 0.0, 9e-6), (jumping, 225.0 + 1 / 12, 0.0)):
        found = [
            pooled_of(draw(sensor, 200, 1.0, rng), draw(sensor, 200, 2.0, rng)) for _ in range(20)
        ]
        for name, true in (("common_offset_dn2", offset), ("flicker_relative2", flicker)):
            estimates = [getattr(each, name) for each in found]
            z = np.array([(e.value - true) / e.std for e in estimates])
            assert abs(z.mean()) < SEVERAL / np.sqrt(z.size), name


def test_a_spot_in_the_dark_is_weighted_and_covered() -> None:
    place = np.linspace(-30, 30, 2000)
    sensor = Sensor.flat(2000, 1.0, 30.0)
    spot = Sensor(sensor.gain, sensor.bias + 200.0, 500.0 * np.exp(-(place**2)), 30.0)
    rng = np.random.default_rng(3)
    every, summed = [], []
    for _ in range(100):
        first, second = plain(spot, 100, 1.0, rng), plain(spot, 100, 2.0, rng)
        every.append(pooled_of(first, second).system_gain_dn_per_e)
        mean = second.mean(axis=0) - first.mean(axis=0)
        variance = second.var(axis=0, ddof=1) - first.var(axis=0, ddof=1)
        summed.append(variance.sum() / mean.sum())
    z = np.array([(e.value - 1.0) / e.std for e in every])
    spread, of_spread = spread_of(z)
    assert abs(spread - 1.0) < 0.1 + 2 * of_spread
    assert abs(z.mean()) < SEVERAL / np.sqrt(z.size)
    # The plain ratio of sums is unbiased too, but takes the dark pixels' noise along.
    assert np.mean([e.std for e in every]) < 0.8 * np.std(summed, ddof=1)


def test_variances_that_scatter_together_widen_the_error() -> None:
    # Eight pixels at a time have one noise: fewer are independent than counted.
    sensor = Sensor.flat(400, 10_000.0, 10.0)
    rng = np.random.default_rng(4)
    z, dispersion = [], []
    for _ in range(120):
        frames = [plain(sensor, 400, light, rng) for light in (1.0, 2.0)]
        for dn in frames:
            dn[:, 50:] = np.tile(dn[:, :50], 7)
        found = pooled_of(*frames)
        z.append((found.system_gain_dn_per_e.value - 1.0) / found.system_gain_dn_per_e.std)
        dispersion += found.dispersion
    # Frames' means take 1/50 of these variances off: 4 % of their squares, as expected.
    error = np.std(dispersion) / np.sqrt(240)
    assert abs(np.mean(dispersion) - 8.0) < 2 * 0.04 * 8.0 + SEVERAL * error
    spread, of_spread = spread_of(np.array(z))
    assert abs(spread - 1.0) < 0.1 + 2 * of_spread


def test_sums_of_single_pixels_come_out_high_and_pooled_ones_do_not() -> None:
    sensor = Sensor.flat(4000, 10_000.0, 10.0)
    first, second = sensor.frames(100, 1), sensor.frames(100, 2, 2.0)
    pair = drawn_pair(sensor, 100, key=8)
    usable = sanuc(pair).valid
    summed = np.sum(pair.difference_dn[usable] ** 2 / pair.variance_difference_dn2[usable])
    excess = summed / (usable.sum() * 10_000.0) - 1.0
    assert 0.06 < excess < 0.20
    pooled = pooled_of(first, second).photoelectrons
    assert abs(pooled.value - 10_000.0) < SEVERAL * pooled.std
    assert pooled.std < 0.01 * 10_000.0


def test_a_ratio_of_sums_weights_gains_with_the_signal_and_ours_does_not() -> None:
    spread = 0.2
    sensor = Sensor.flat(2000, 10_000.0, 10.0, spread=spread)
    true = sensor.gain.mean()
    rng = np.random.default_rng(6)
    ours, sums = [], []
    for _ in range(20):
        first, second = plain(sensor, 200, 1.0, rng), plain(sensor, 200, 2.0, rng)
        ours.append(pooled_of(first, second))
        variance = second.var(axis=0, ddof=1) - first.var(axis=0, ddof=1)
        sums.append(variance.sum() / (second.mean() - first.mean()) / 2000)
    error = np.std(sums, ddof=1) / np.sqrt(20)
    signal_weighted = np.sum(sensor.gain**2) / np.sum(sensor.gain)
    assert abs(np.mean(sums) - signal_weighted) < SEVERAL * error
    assert abs(np.mean([o.system_gain_dn_per_e.value for o in ours]) - true) < SEVERAL * error
    electrons = [o.photoelectrons.value for o in ours]
    assert abs(np.mean(electrons) - 1e4) < SEVERAL * error / true * 1e4
    assert signal_weighted - true > 2 * SEVERAL * error  # they can be told apart


def test_s3nuc_pooled_agrees_within_its_much_larger_errors() -> None:
    sensor = Sensor.flat(2000, 20.0, 2.0)
    scores = []
    for key in range(40):
        first, second = sensor.frames(400, 2 * key), sensor.frames(400, 2 * key + 1, 2.0)
        third, plainly = pooled_of(first, second, method="s3nuc"), pooled_of(first, second)
        assert third.photoelectrons.std > 3 * plainly.photoelectrons.std
        true = (20.0, sensor.bias.mean(), 4.0)
        found = (third.photoelectrons, third.bias_dn, third.read_noise_variance_dn2)
        scores.append([(e.value - t) / e.std for e, t in zip(found, true, strict=True)])
    for z in np.array(scores).T:
        spread, of_spread = spread_of(z)
        assert abs(spread - 1.0) < SEVERAL * of_spread
        assert abs(z.mean()) < SEVERAL / np.sqrt(z.size)


def test_no_light_is_no_gain_and_says_so() -> None:
    sensor = Sensor.flat(100, 1e-3, 5.0)
    found = pooled_of(sensor.frames(50, 1), sensor.frames(50, 2, 2.0))
    assert not found.photoelectrons.is_known
    assert "variance does not grow" in found.photoelectrons.reason
    assert found.answer()["read_noise_e"]["value"] is None


def test_propagation_is_that_of_the_derivatives() -> None:
    covariance = np.array([[4.0, 1.0], [1.0, 9.0]])
    value, of_value = propagate(
        lambda x: np.array([x[0] * x[1], x[0] ** 2]), np.array([100.0, 200.0]), covariance
    )
    jacobian = np.array([[200.0, 100.0], [200.0, 0.0]])
    assert np.allclose(value, [20_000.0, 10_000.0], rtol=1e-12)
    assert np.allclose(of_value, jacobian @ covariance @ jacobian.T, rtol=1e-8)
