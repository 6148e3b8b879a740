import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.difference_sums import LagSums, TapRuns
from calib.kernels.pair_sums import first_row_sums, lag_sums, row_sums

LAGS = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, -1), (2, -2))


def plain_lag_sums(
    difference: NDArray[np.int64], centre: NDArray[np.int32], limit: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The same with NumPy, over one stretch of at most 128 rows; `centre` by pixel."""
    rest = 64 * difference - centre
    good = np.abs(rest) <= limit
    steps = np.where(good, rest, 0)
    n, m = difference.shape
    products, counts = [], []
    for down, along in LAGS:
        of = slice(max(0, -along), m - max(0, along))
        to = slice(max(0, along), m + min(0, along))
        one, other = steps[: n - down, of], steps[down:, to]
        both = good[: n - down, of] & good[down:, to]
        row, count = np.zeros(m, np.int64), np.zeros(m, np.int64)
        row[of], count[of] = (one * other).sum(axis=0), both.sum(axis=0)
        products.append(row)
        counts.append(count)
    return np.array(products), np.array(counts)


def drawn(shape: tuple[int, int], dtype: type, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng([seed, *shape])
    top = np.iinfo(dtype).max
    later, earlier = rng.integers(0, top, (2, *shape), endpoint=True).astype(dtype)
    return later, earlier


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", [(1, 5), (3, 3), (40, 70), (128, 2051), (127, 4097)])
@pytest.mark.parametrize("share_kept", [1.0, 0.98, 0.3])
def test_products_are_exact(shape: tuple[int, int], dtype: type, share_kept: float) -> None:
    later, earlier = drawn(shape, dtype, 1)
    difference = later.astype(np.int64) - earlier
    rng = np.random.default_rng(shape)
    tap = np.arange(shape[1]) % 2
    centre = rng.integers(-300, 300, (shape[0], 2), dtype=np.int32)
    largest = 64 * np.quantile(np.abs(difference), share_kept) + 600 * (share_kept == 1)
    limit = (largest + rng.integers(0, 64, shape[1])).astype(np.int32)
    found = lag_sums(later, earlier, TapRuns.of(tap), limit, centre, lags=LAGS)
    products, counts = plain_lag_sums(difference, centre[:, tap], limit)
    assert np.array_equal(found.products, products)
    assert np.array_equal(found.counts, counts)
    assert (counts[0] == shape[0]).all() == (share_kept == 1)


def test_long_runs_of_rows_are_the_sum_of_stretches_of_128() -> None:
    later, earlier = drawn((300, 9), np.uint16, 2)
    taps, limit = TapRuns.of(np.zeros(9, np.intp)), np.full(9, 64 * 40000, np.int32)
    centre = np.zeros((300, 1), np.int32)
    parts = [
        lag_sums(
            later[k : k + 128], earlier[k : k + 128], taps, limit, centre[k : k + 128], lags=LAGS
        )
        for k in (0, 128, 256)
    ]
    whole = lag_sums(later, earlier, taps, limit, centre, lags=LAGS)
    added = sum(parts, LagSums.zero(len(LAGS), 9))
    assert np.array_equal(whole.products, added.products)
    assert np.array_equal(whole.counts, added.counts)


def test_full_scale_differences_do_not_overflow() -> None:
    later, earlier = np.full((128, 3), 65535, np.uint16), np.zeros((128, 3), np.uint16)
    taps, limit = TapRuns.of(np.zeros(3, np.intp)), np.full(3, 1 << 30, np.int32)
    centre = np.zeros((128, 1), np.int32)
    found = lag_sums(later, earlier, taps, limit, centre, lags=((0, 0),))
    assert [int(p) for p in found.products[0]] == [128 * (64 * 65535) ** 2] * 3


def test_row_sums_are_those_of_the_differences_within_limits() -> None:
    later, earlier = drawn((17, 31), np.uint16, 3)
    difference = later.astype(np.int64) - earlier
    tap = np.arange(31) // 16
    taps = TapRuns.of(tap)
    rng = np.random.default_rng(0)
    limit = rng.integers(64_000, 64 * 9_000, 31, dtype=np.int32)
    first = first_row_sums(later, earlier, taps, limit)
    cut = np.clip(difference, -(limit // 16), limit // 16)
    centre = rng.integers(-6400, 6400, (17, 2), dtype=np.int32)
    second = row_sums(later, earlier, taps, limit, centre)
    kept = np.abs(64 * difference - centre[:, tap]) <= limit
    assert 0.1 < kept.mean() < 0.9
    for side in (0, 1):
        of = tap == side
        assert np.array_equal(first.differences[:, side], cut[:, of].sum(axis=1))
        assert (first.counts[:, side] == of.sum()).all()
        assert np.array_equal(second.counts[:, side], kept[:, of].sum(axis=1))
        assert np.array_equal(second.differences[:, side], (difference * kept)[:, of].sum(axis=1))
