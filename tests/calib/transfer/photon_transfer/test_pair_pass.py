"""The one pass over frames: variances, covariances, what is shared, outliers, and their errors."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from numpy.random import Generator
from numpy.typing import NDArray

from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.statistics import CancelledError
from calib.transfer.photon_transfer.cells import BlockCells
from calib.transfer.photon_transfer.from_pairs import variance_of_variance
from calib.transfer.photon_transfer.pair_pass import pair_statistics
from tests.calib.transfer.photon_transfer.simulated import Held

GAIN, READ_DN = 0.25, 3.0


def held(dn: NDArray[np.uint16], camera: CameraHeader, edges: Sequence[int] = ()) -> Held:
    """One flat block in stretches that end at `edges`."""
    bounds = [0, *edges, len(dn)]
    stretches = tuple(dn[a:b] for a, b in pairwise(bounds))
    block = Block(block="000", kind="flat", exposure_us=100.0, level=1.0, lines=len(dn))
    return Held(RecordingHeader(camera=camera, blocks=(block,)), {"000": stretches})


def drawn(
    expected_dn: NDArray[np.float64], rng: Generator, offset_dn: float = 100.0
) -> NDArray[np.uint16]:
    volts = GAIN * rng.poisson(expected_dn / GAIN)
    volts = volts + READ_DN * rng.standard_normal(expected_dn.shape) + offset_dn
    return np.clip(np.rint(volts), 0, 65535).astype(np.uint16)


def truth(expected_dn: NDArray[np.float64]) -> NDArray[np.float64]:
    return GAIN * expected_dn + READ_DN**2 + 1 / 12


def z_of(cells: BlockCells, expected_dn: NDArray[np.float64]) -> NDArray[np.float64]:
    own = cells.square_factor * truth(expected_dn) ** 2
    own += cells.cumulant_factor * GAIN**3 * expected_dn
    return (cells.variance_dn2 - truth(expected_dn)) / np.sqrt(own)


def assert_standard(z: NDArray[np.float64]) -> None:
    assert abs(z.mean()) < 5 / np.sqrt(z.size)
    # The variance of few numbers is skewed: its kurtosis makes the spread less sure than 1/√2n.
    assert abs(z.std() - 1) < 5 * np.sqrt(0.75 / z.size)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("layout", ["odd_even", "halves"])
def test_line_variances_and_their_errors_are_right(layout: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    camera = CameraHeader(columns=600, bit_depth=16, taps=2, tap_layout=layout)
    expected = np.linspace(300.0, 900.0, 600)
    shape = (120, 600)
    dn = drawn(np.broadcast_to(expected, shape), rng) + rng.integers(0, 30, (120, 1), np.uint16)
    (cells,) = pair_statistics(held(dn.astype(np.uint16), camera, (7, 8, 50)))
    assert_standard(z_of(cells, expected))
    common = (30**2 - 1) / 12
    assert (np.abs(cells.common_dn2 / common - 1) < 5 * np.sqrt(3 / 120)).all()
    for k, lag in enumerate(cells.lags):
        own = np.sqrt(np.nanmean(cells.square_factor * truth(expected) ** 2) / 2 / 600)
        assert abs(np.nanmean(cells.covariance_dn2[k])) < 5 * own, lag
    seams = np.flatnonzero(np.isnan(cells.covariance_dn2[1]))
    assert seams.tolist() == ([598, 599] if layout == "odd_even" else [298, 299, 598, 599])


@pytest.mark.parametrize("seed", range(3))
def test_area_variances_and_their_errors_are_right(seed: int) -> None:
    rng = np.random.default_rng(seed)
    camera = CameraHeader(columns=90, rows=101, bit_depth=16, taps=4, tap_layout="quadrants")
    expected = np.linspace(300.0, 900.0, 90)
    dn = drawn(np.broadcast_to(expected, (9, 101, 90)), rng)
    dn = (dn + rng.integers(0, 30, (9, 1, 1), np.uint16)).astype(np.uint16)
    (cells,) = pair_statistics(held(dn, camera, (1, 4)))
    n_bands = len(cells.mean_dn) // 90
    assert_standard(z_of(cells, np.tile(expected, n_bands)))
    for k, (row, _) in enumerate(cells.lags):
        share = 1 - row * n_bands / 101
        own = np.sqrt(np.mean(truth(expected) ** 2) * 23 / 64 / 2 / (101 * 90 * share))
        assert abs(np.nanmean(cells.covariance_dn2[k])) < 5 * own


@pytest.mark.parametrize("edges", [(1,), (2, 3, 5), (128,), (129, 200)])
def test_stretches_do_not_change_what_is_found(edges: tuple[int, ...]) -> None:
    camera = CameraHeader(columns=64, bit_depth=16)
    rng = np.random.default_rng(1)
    dn = drawn(np.full((260, 64), 500.0), rng)
    whole, parts = (pair_statistics(held(dn, camera, e), clip_sigma=30.0)[0] for e in ((), edges))
    assert np.array_equal(whole.mean_dn, parts.mean_dn)
    assert np.allclose(whole.variance_dn2, parts.variance_dn2, rtol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_neighbours_that_share_charge_show_it_at_their_lag(seed: int) -> None:
    rng = np.random.default_rng(seed)
    camera = CameraHeader(columns=80, rows=80, bit_depth=16)
    own = rng.standard_normal((6, 80, 81)) * 20
    dn = np.rint(1000 + own[..., 1:] + 0.1 * own[..., :-1]).astype(np.uint16)
    (cells,) = pair_statistics(held(dn, camera))
    error = 404.0 * np.sqrt(14 / 25 / 2 / 6400)
    for k, lag in enumerate(cells.lags):
        wanted = 0.1 * 400.0 if lag == (0, 1) else 0.0
        assert abs(np.nanmean(cells.covariance_dn2[k]) - wanted) < 5 * error, lag


@pytest.mark.parametrize("seed", range(3))
def test_what_a_line_takes_from_the_one_before_is_seen(seed: int) -> None:
    rng = np.random.default_rng(seed)
    own = rng.standard_normal((301, 500)) * 20
    dn = np.rint(1000 + own[1:] + 0.05 * own[:-1]).astype(np.uint16)
    (cells,) = pair_statistics(held(dn, CameraHeader(columns=500, bit_depth=16)))
    error = 400.0 * np.sqrt(2 / 300 / 500)
    assert abs(cells.line_covariance_dn2.mean() - 0.05 * 400.0) < 5 * error


@pytest.mark.parametrize("clip_sigma", [3.0, 5.0])
@pytest.mark.parametrize("seed", range(3))
def test_outliers_are_left_out_and_the_cut_is_undone(seed: int, clip_sigma: float) -> None:
    rng = np.random.default_rng(seed)
    expected = np.full(2000, 600.0)
    dn = drawn(np.broadcast_to(expected, (100, 2000)), rng)
    hit = rng.random(dn.shape) < 2e-4
    dn[hit] += 3000
    camera = CameraHeader(columns=2000, bit_depth=16)
    (cells,) = pair_statistics(held(dn, camera), clip_sigma=clip_sigma)
    z = z_of(cells, expected)
    assert abs(z.mean()) < 5 / np.sqrt(2000)
    cut = {3.0: 0.0027, 5.0: 0.0}[clip_sigma]
    assert abs(cells.rejected_share - cut - 2 * 2e-4) < 5 * np.sqrt(1e-3 / dn.size) + 0.1 * cut


def test_a_giant_outlier_does_not_pull_its_line() -> None:
    rng = np.random.default_rng(0)
    expected = np.full(64, 600.0)
    dn = drawn(np.broadcast_to(expected, (400, 64)), rng)
    dn[200, 5] = 65535
    (cells,) = pair_statistics(held(dn, CameraHeader(columns=64, bit_depth=16)))
    assert abs(z_of(cells, expected).mean()) < 5 / np.sqrt(64)
    assert cells.rejected_share == pytest.approx(2 / (399 * 64), rel=0.5)


@pytest.mark.parametrize("n", [2, 3, 12])
@pytest.mark.parametrize("electrons", [1.0, 20.0])
def test_the_variance_of_a_variance_counts_overlap_and_kurtosis(n: int, electrons: float) -> None:
    rng = np.random.default_rng(n)
    x = rng.poisson(electrons, (200_000, n)).astype(np.float64)
    seen = (np.diff(x, axis=1) ** 2).mean(axis=1) / 2
    square, cumulant = variance_of_variance(n, np.ones(1))
    wanted = float(square[0] * electrons**2 + cumulant[0] * electrons)
    fourth = np.mean((seen - seen.mean()) ** 4)
    error = np.sqrt((fourth - seen.var() ** 2) / len(seen))
    assert abs(seen.var() - wanted) < 4 * error


def test_one_exposure_has_no_variance() -> None:
    dn = np.full((1, 10), 500, np.uint16)
    (cells,) = pair_statistics(held(dn, CameraHeader(columns=10, bit_depth=16)))
    assert np.isnan(cells.variance_dn2).all()
    assert np.isinf(cells.square_factor).all()
    assert (cells.mean_dn == 500).all()


def test_a_pass_tells_how_far_it_is_and_stops_when_asked() -> None:
    recording = held(np.full((20, 10), 500, np.uint16), CameraHeader(columns=10, bit_depth=16))
    done: list[float] = []
    pair_statistics(recording, progress=done.append)
    assert done == sorted(done)
    assert done[-1] == 1.0
    with pytest.raises(CancelledError):
        pair_statistics(recording, cancelled=lambda: True)


@pytest.mark.parametrize("seed", range(3))
def test_what_the_common_mean_takes_with_it_is_put_back(seed: int) -> None:
    # Of eight columns it takes an eighth of the variance, and leaves as much of a covariance.
    rng = np.random.default_rng(seed)
    expected = np.linspace(200.0, 1800.0, 8)
    dn = drawn(np.broadcast_to(expected, (20_000, 8)), rng) + rng.integers(0, 9, (20_000, 1))
    (cells,) = pair_statistics(held(dn.astype(np.uint16), CameraHeader(columns=8, bit_depth=16)))
    assert (np.abs(z_of(cells, expected)) < 5).all()
    wide = truth(expected)
    for k, (_, lag) in enumerate(cells.lags):
        error = np.sqrt(1.5 / 20_000 * wide[:-lag] * wide[lag:])
        assert (np.abs(cells.covariance_dn2[k, :-lag]) < 5 * error).all()
