"""Compiled loops over two exposures against their NumPy twins."""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter

from calib.kernels.neighbour_means import neighbour_means
from calib.kernels.pixel_weights import Typical, pixel_weights
from calib.kernels.pooled_sums import ALL_TAPS, covariance_sums, weighted_sums
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps
from calib.transfer.two_exposures.pixel_state import PixelState
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sampling import sampling_covariances
from calib.transfer.two_exposures.sanuc import sanuc
from tests.calib.kernels import numpy_two_exposures as twin
from tests.calib.transfer.two_exposures.stacks import Sensor, pair_of

ULP = float(np.finfo(np.float64).eps)
SEVERAL = 8 * ULP  # the longest chain has 30 roundings of half an ulp: their root is below 3
TYPICAL = Typical(0.9, 30.0, 101.0)
N_PIXELS = 5000


def drawn(
    seed: int, n_frames: int = 60, ratio: float = 2.0, ratio_std: float = 0.0
) -> ExposurePair:
    """Pixels from dark to bright, and some of every state."""
    flat = Sensor.flat(N_PIXELS, 1.0, 6.0, 0.8, spread=0.05)
    sensor = replace(flat, electrons=np.geomspace(2.0, 2e4, N_PIXELS))
    one, two = sensor.frames(n_frames, 2 * seed), sensor.frames(n_frames, 2 * seed + 1, ratio)
    one, two = one.copy(), two.copy()
    two[3, 4000] = 65535
    one[7, 4001] = 0
    one[:, 4002] = two[:, 4002] = 77
    two[:, 4003] = one[:, 4003]
    pair = pair_of(one, two, ratio)
    return replace(pair, ratio_std=ratio_std)


PAIRS = [(1, 60, 2.0, 0.0), (2, 8, 1.9, 1e-3), (3, 200, 3.0, 1e-4)]


@pytest.mark.parametrize("of_pair", PAIRS)
@pytest.mark.parametrize(("compiled", "plain"), [(sanuc, twin.sanuc), (s3nuc, twin.s3nuc)])
def test_maps_are_those_of_numpy(
    compiled: Callable[[ExposurePair], PixelMaps],
    plain: Callable[[ExposurePair], PixelMaps],
    of_pair: tuple[int, int, float, float],
) -> None:
    pair = drawn(*of_pair)
    ours, theirs = compiled(pair), plain(pair)
    assert np.array_equal(ours.reason, theirs.reason)
    assert set(PixelState) == set(np.unique(ours.reason).tolist())
    # Differences are right to the ulp of what is taken from each other.
    terms = {
        "bias_dn": pair.first.mean_dn + np.abs(pair.first.mean_dn - theirs.bias_dn),
        "read_noise_variance_dn2": pair.second.variance_dn2
        + np.abs(pair.first.variance_dn2 - theirs.read_noise_variance_dn2),
        "gain_bias_covariance": theirs.system_gain_dn_per_e_std * theirs.bias_dn_std,
    }
    # S3NUC's derivative of σ² by σ₁² is 1 − T/(G²D), of which at eight frames little may be left.
    looser = {"read_noise_variance_dn2_std": 8.0 * SEVERAL}
    for field in fields(PixelMaps):
        one, two = getattr(ours, field.name), getattr(theirs, field.name)
        scale = terms.get(field.name, np.abs(two))
        assert np.array_equal(np.isnan(one), np.isnan(two)), field.name
        known, bound = ~np.isnan(two), looser.get(field.name, SEVERAL)
        assert np.all(np.abs(one - two)[known] <= bound * scale[known]), field.name


@pytest.mark.parametrize(
    ("shape", "size"), [((50, 100), 9), ((7, 3), 9), ((5000,), 65), ((1,), 65)]
)
def test_neighbour_means_are_those_of_a_box(shape: tuple[int, ...], size: int) -> None:
    rng = np.random.default_rng(4)
    one, two = (1000.0 * k + 100.0 * rng.normal(size=shape) for k in (1, 3))
    where = rng.random(shape) < 0.5
    where.ravel()[: where.size // 3] = False  # far from any pixel that counts
    found = neighbour_means(one.ravel(), two.ravel(), where.ravel(), shape, size)
    total = uniform_filter(np.where(where, two - one, 0.0), size, mode="nearest")
    share = uniform_filter(where.astype(np.float64), size, mode="nearest")
    seen = share > 0.5 / size ** len(shape)
    assert np.allclose(
        found.reshape(shape)[seen], (total / np.where(seen, share, 1.0))[seen], 1e-10
    )
    assert np.all(np.abs(found.reshape(shape)[~seen]) < 1e-8)  # DN; rounding of the running sums


def test_neighbour_means_do_not_depend_on_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    one, two = rng.normal(size=6000), rng.normal(10.0, size=6000)
    where = np.ones(6000, np.bool_)
    whole = neighbour_means(one, two, where, (60, 100), 9)
    monkeypatch.setattr("calib.kernels.neighbour_means._BAND", 700)
    assert np.allclose(neighbour_means(one, two, where, (60, 100), 9), whole, rtol=1e-12)


def test_weights_are_those_of_numpy() -> None:
    pair = drawn(6, ratio=1.9)
    smooth = pair.difference_dn / 0.9
    smooth[::50] = -1.0
    where = np.arange(N_PIXELS) % 7 > 0
    ours = pixel_weights(pair.arrays(0.9), smooth, where, TYPICAL)
    a, beta, q = twin.pixel_weights(pair, smooth, where, TYPICAL)
    # The signal is what is left of the mean without the bias, and a is divided by it.
    lit = np.maximum(smooth, 1e-3)
    left = np.clip(q, lit / 4.0, lit * 4.0) / pair.second.mean_dn
    assert np.all(np.abs(ours[0] - a) <= SEVERAL * a * (1.0 + 1.0 / left))
    assert np.all(np.abs(ours[1] - beta) <= SEVERAL * beta)
    assert np.all(np.abs(ours[2] - q) <= SEVERAL * pair.second.mean_dn)
    assert np.all(ours[0][~where] == 0)
    assert np.all(ours[1][~where] == 0)


@pytest.mark.parametrize("interleaved", [False, True])
def test_sums_are_those_of_numpy(interleaved: bool) -> None:
    pair = drawn(8)
    smooth, where = pair.difference_dn + 1.0, np.arange(N_PIXELS) % 7 > 0
    number = np.arange(N_PIXELS)
    tap = (number % 3 if interleaved else number * 3 // N_PIXELS).astype(np.uint8)
    found = weighted_sums(pair.arrays(0.0), smooth, where, tap, TYPICAL, n_taps=3)
    a, beta, q = pixel_weights(pair.arrays(0.0), smooth, where, TYPICAL)
    one, two, none = pair.first, pair.second, np.zeros(N_PIXELS)
    moments = [np.ones(N_PIXELS), one.mean_dn, two.mean_dn, one.variance_dn2, two.variance_dn2]
    third = [one.third_dn3, two.third_dn3]
    for k, (weight, columns) in enumerate(
        [
            (a, [*moments, none, none, q, q**2]),
            (beta, [moments[0], none, none, *moments[3:], none, none, q, q**2]),
            (where * 1.0, [*moments[:3], none, none, *third, q, q**2]),
            (np.ones(N_PIXELS), [*moments, *[none] * 4]),
        ]
    ):
        for t in range(3):
            members = tap == t
            terms = np.stack(columns)[:, members] * weight[members]
            bound = len(weight) * ULP * np.abs(terms).sum(axis=1)
            assert np.all(np.abs(found[t, k] - terms.sum(axis=1)) <= bound), (k, t)


@pytest.mark.parametrize("of_tap", [ALL_TAPS, 1])
def test_covariances_of_sums_are_those_of_numpy(of_tap: int) -> None:
    pair, gain = drawn(9, ratio=1.9), 0.8
    smooth, where = pair.difference_dn + 1.0, np.arange(N_PIXELS) % 7 > 0
    tap = (np.arange(N_PIXELS) % 3).astype(np.uint8)
    common = ((1.5, 1e-5), (2.5, 4e-5))
    found, powers = covariance_sums(
        pair.arrays(gain), smooth, where, tap, TYPICAL, of_tap=of_tap, common=common, every=2
    )
    a, beta, q = pixel_weights(pair.arrays(gain), smooth, where, TYPICAL)
    members = ((tap == of_tap) | (of_tap == ALL_TAPS)) & (np.arange(N_PIXELS) % 2 == 0)
    first, second = (
        replace(e, variance_dn2=e.variance_dn2 - c[0] - c[1] * q**2)
        for e, c in zip((pair.first, pair.second), common, strict=True)
    )
    w = np.stack([a, a, where * 1.0, beta, where * 1.0]) * members
    exposures = zip(
        (first, second), sampling_covariances(replace(pair, first=first, second=second), gain),
        strict=True,
    )  # fmt: skip
    for k, (exposure, cov) in enumerate(exposures):
        of = {"mm": cov.mean, "mv": cov.mean_variance, "vv": cov.variance, "mt": cov.mean_third}
        of |= {"tv": cov.variance_third, "tt": cov.third}
        expected = [[2 * np.sum(w[i] * w[j] * of["".join(sorted(x + y))])
                     for j, y in enumerate("mvmvt")] for i, x in enumerate("mvmvt")]  # fmt: skip
        assert np.allclose(found[k], expected, rtol=1e-11, atol=0)
        v = exposure.variance_dn2[members]
        expected_powers = [2 * np.sum(cov.variance[members]), np.sum(v), np.sum(v**2)]
        assert np.allclose(powers[k], expected_powers, rtol=1e-11, atol=0)
