from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.line_sums import LaggedSums, LineSums
from calib.kernels.sums import lagged_sums, line_sums

Codes = NDArray[np.uint8] | NDArray[np.uint16]


def plain_sums(dn: Codes, full_scale_dn: int) -> LineSums:
    """The same with NumPy, in 64 bits."""
    wide = dn.astype(np.uint64)
    return LineSums(
        len(dn),
        wide.sum(axis=0, dtype=np.uint64),
        (wide**2).sum(axis=0, dtype=np.uint64),
        (dn == 0).sum(axis=0, dtype=np.uint64),
        (dn >= full_scale_dn).sum(axis=0, dtype=np.uint64),
    )


def assert_same(some: LineSums, other: LineSums) -> None:
    assert some.n_lines == other.n_lines
    for name in ("codes", "squares", "at_zero", "at_full_scale"):
        assert np.array_equal(getattr(some, name), getattr(other, name)), name


def drawn(shape: tuple[int, int], dtype: type, full_scale_dn: int, seed: int = 0) -> Codes:
    rng = np.random.default_rng([seed, *shape])
    dn: Codes = rng.integers(0, full_scale_dn + 1, shape).astype(dtype)
    dn[rng.random(shape) < 0.05] = 0
    dn[rng.random(shape) < 0.05] = full_scale_dn
    return dn


SHAPES = [(1, 1), (1, 7), (2, 1), (3, 5), (4, 8), (5, 33), (7, 100), (64, 8191), (9, 8193)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    ("dtype", "full_scale_dn"), [(np.uint8, 255), (np.uint16, 4095), (np.uint16, 65535)]
)
def test_sums_are_exact(shape: tuple[int, int], dtype: type, full_scale_dn: int) -> None:
    dn = drawn(shape, dtype, full_scale_dn)
    assert_same(line_sums(dn, full_scale_dn), plain_sums(dn, full_scale_dn))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("dtype", "full_scale_dn"), [(np.uint8, 255), (np.uint16, 65535)])
def test_lagged_products_are_exact(shape: tuple[int, int], dtype: type, full_scale_dn: int) -> None:
    dn = drawn(shape, dtype, full_scale_dn)
    lagged: LaggedSums = lagged_sums(dn, full_scale_dn)
    wide = dn.astype(np.uint64)
    assert_same(lagged.sums, plain_sums(dn, full_scale_dn))
    along = (wide[:, :-1] * wide[:, 1:]).sum(axis=0, dtype=np.uint64)
    below = (wide[:-1] * wide[1:]).sum(axis=0, dtype=np.uint64)
    assert np.array_equal(lagged.column_products, along)
    assert np.array_equal(lagged.line_products, below)


@pytest.mark.parametrize("code", [0, 4095])
@pytest.mark.parametrize("line", range(19))
def test_a_single_clipped_sample_is_counted_wherever_it_stands(line: int, code: int) -> None:
    dn = np.full((19, 8200), 2000, np.uint16)
    dn[line, 17 * line] = dn[line, 8199] = code
    assert_same(line_sums(dn, 4095), plain_sums(dn, 4095))


@pytest.mark.parametrize("n_lines", [65535, 65536, 65537, 65538, 65541, 140_003])
def test_full_scale_16_bit_lines_do_not_overflow(n_lines: int) -> None:
    dn = np.full((n_lines, 2), 65535, np.uint16)
    sums = line_sums(dn, 65535)
    assert [int(each) for each in sums.codes] == [n_lines * 65535] * 2
    assert [int(each) for each in sums.squares] == [n_lines * 65535**2] * 2
    assert [int(each) for each in sums.at_full_scale] == [n_lines] * 2
    lagged = lagged_sums(dn, 65535)
    assert int(lagged.column_products[0]) == n_lines * 65535**2
    assert int(lagged.line_products[0]) == (n_lines - 1) * 65535**2


@pytest.mark.parametrize("step", [1, 2, 3, 5, 40])
@pytest.mark.parametrize("first", [0, 1, 4, 36])
def test_every_so_many_lines_are_those_of_a_slice(first: int, step: int) -> None:
    dn = drawn((37, 11), np.uint16, 4095)
    assert_same(line_sums(dn, 4095, first=first, step=step), plain_sums(dn[first::step], 4095))


@pytest.mark.parametrize("n_threads", [1, 2, 3, 50])
def test_threads_share_the_lines_without_changing_the_sums(n_threads: int) -> None:
    dn = drawn((37, 11), np.uint16, 4095)
    with ThreadPoolExecutor(2) as pool:
        shared = line_sums(dn, 4095, first=1, step=2, pool=pool, n_threads=n_threads)
    assert_same(shared, plain_sums(dn[1::2], 4095))


def test_sums_of_parts_add_up_and_subtract() -> None:
    dn = drawn((30, 9), np.uint16, 65535)
    every, part = line_sums(dn, 65535), line_sums(dn[:7], 65535)
    assert_same(part + line_sums(dn[7:], 65535), every)
    assert_same(every - part, plain_sums(dn[7:], 65535))
    assert_same(every + LineSums.zero(9), every)


@pytest.mark.parametrize("level_dn", [0, 3, 4095, 65530])
def test_variance_is_correct_to_rounding_at_any_level(level_dn: int) -> None:
    dn = level_dn + np.random.default_rng(level_dn).integers(0, 6, (997, 50)).astype(np.uint16)
    sums = line_sums(dn.astype(np.uint16), 65535)
    wanted = (dn.astype(np.float64) - level_dn).var(axis=0, ddof=1)
    assert np.allclose(sums.variance_dn2, wanted, rtol=1e-13, atol=0)
    assert np.allclose(sums.mean_dn, dn.mean(axis=0), rtol=1e-15, atol=0)


def test_a_constant_column_has_no_variance_and_one_line_an_unknown_one() -> None:
    assert (line_sums(np.full((714, 3), 65535, np.uint16), 65535).variance_dn2 == 0).all()
    assert np.isnan(line_sums(np.full((1, 3), 7, np.uint16), 65535).variance_dn2).all()
    assert np.isnan(LineSums.zero(3).mean_dn).all()


def test_the_codes_are_left_alone() -> None:
    dn = drawn((20, 20), np.uint16, 4095)
    dn.flags.writeable = False
    line_sums(dn, 4095)
    lagged_sums(dn, 4095)
