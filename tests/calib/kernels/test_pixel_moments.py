from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.errors import InputError
from calib.kernels.central_moments import central_moments
from calib.kernels.pixel_moments import PixelAccumulator
from calib.kernels.pixel_sums import PixelSums, most_frames

Codes = NDArray[np.uint8] | NDArray[np.uint16]


def one_tap(n_pixels: int) -> NDArray[np.uint8]:
    return np.zeros(n_pixels, np.uint8)


def accumulated(dn: Codes, full_scale_dn: int = 65535) -> PixelAccumulator:
    accumulator = PixelAccumulator(one_tap(dn.shape[1]), full_scale_dn)
    accumulator.add(dn)
    return accumulator


def exact_moments(codes: list[int]) -> tuple[Fraction, Fraction, Fraction]:
    """Mean, k2 and k3 of one pixel in whole numbers and fractions."""
    n = len(codes)
    mean = Fraction(sum(codes), n)
    second, third = (sum((x - mean) ** power for x in codes) for power in (2, 3))
    return mean, Fraction(second, n - 1), third * n / ((n - 1) * (n - 2))


def drawn(shape: tuple[int, int], dtype: type, full_scale_dn: int, seed: int = 0) -> Codes:
    rng = np.random.default_rng([seed, *shape])
    dn: Codes = rng.integers(0, full_scale_dn + 1, shape).astype(dtype)
    dn[rng.random(shape) < 0.05] = 0
    dn[rng.random(shape) < 0.05] = full_scale_dn
    return dn


SHAPES = [(1, 1), (2, 3), (7, 5), (8, 5), (9, 33), (16, 2047), (27, 2048), (40, 2049), (17, 5000)]
KINDS = [(np.uint8, 255), (np.uint16, 4095), (np.uint16, 65535)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("dtype", "full_scale_dn"), KINDS)
def test_sums_are_exact(shape: tuple[int, int], dtype: type, full_scale_dn: int) -> None:
    dn = drawn(shape, dtype, full_scale_dn)
    done = accumulated(dn, full_scale_dn)
    wide = dn.astype(np.uint64)
    assert done.sums.n_frames == len(dn)
    assert np.array_equal(done.sums.codes, wide.sum(axis=0))
    assert np.array_equal(done.sums.squares, (wide**2).sum(axis=0))
    assert np.array_equal(done.sums.cubes, (wide**3).sum(axis=0))
    assert np.array_equal(done.sums.at_zero, (dn == 0).sum(axis=0))
    assert np.array_equal(done.sums.at_full_scale, (dn >= full_scale_dn).sum(axis=0))
    assert np.array_equal(done.frame_sums[:, 0], wide.sum(axis=1))


@pytest.mark.parametrize("level_dn", [0, 100, 8000, 65500])
@pytest.mark.parametrize("n_frames", [3, 8, 101])
def test_moments_are_those_of_exact_arithmetic(level_dn: int, n_frames: int) -> None:
    rng = np.random.default_rng([level_dn, n_frames])
    dn = np.clip(rng.normal(level_dn, 12.0, (n_frames, 20)), 0, 65535).astype(np.uint16)
    dn[0, 0] = 65535 - level_dn
    moments = central_moments(accumulated(dn).sums)
    for pixel in range(dn.shape[1]):
        codes = [int(code) for code in dn[:, pixel]]
        mean, k2, k3 = exact_moments(codes)
        bound = 1e-15 * float(sum(abs(c - round(mean)) ** 3 + (c - mean) ** 2 for c in codes))
        assert abs(Fraction(float(moments.mean_dn[pixel])) - mean) <= 1e-15 * (mean + 1)
        assert abs(Fraction(float(moments.variance_dn2[pixel])) - k2) <= 1e-14 * (k2 + 1)
        assert abs(Fraction(float(moments.third_dn3[pixel])) - k3) <= 4 * n_frames * bound


def test_sums_beyond_64_bits_lose_nothing() -> None:
    # Σx³ of 96,000 frames near full scale exceeds 2⁶⁴; about the mean it is small.
    dn = np.tile(np.array([[65535], [65533], [65534], [65530]], np.uint16), (8_000, 1))
    part = accumulated(dn).sums
    exact = 3 * [int(code) for code in dn[:, 0]]
    assert sum(x**3 for x in exact) > 1 << 64
    moments = central_moments(part + part + part)
    for got, wanted in zip(
        (moments.mean_dn, moments.variance_dn2, moments.third_dn3),
        exact_moments(exact),
        strict=True,
    ):
        assert got[0] == pytest.approx(float(wanted), rel=1e-12)


@pytest.mark.parametrize("full_scale_dn", [255, 4095, 16383, 65535])
def test_the_bound_on_frames_is_the_last_that_fits(full_scale_dn: int) -> None:
    most = most_frames(full_scale_dn)
    assert most * full_scale_dn**3 < 1 << 63 <= (most + 1) * full_scale_dn**3


def test_more_frames_than_the_bound_are_refused() -> None:
    accumulator = PixelAccumulator(one_tap(1), 65535)
    accumulator.add(np.zeros((most_frames(65535), 1), np.uint16))
    with pytest.raises(InputError) as refusal:
        accumulator.add(np.zeros((1, 1), np.uint16))
    assert refusal.value.code == "too-many-frames"


@pytest.mark.parametrize("cuts", [(5,), (8,), (1, 2, 30), (16, 17)])
def test_parts_merge_and_stretches_add_to_the_same(cuts: tuple[int, ...]) -> None:
    dn = drawn((37, 11), np.uint16, 65535)
    every = accumulated(dn).sums
    parts = np.split(dn, cuts)
    merged = sum((accumulated(part).sums for part in parts), PixelSums.zero(11))
    stretched = PixelAccumulator(one_tap(11), 65535)
    for part in parts:
        stretched.add(part)
    for some in (merged, stretched.sums):
        assert some.n_frames == 37
        for name in ("codes", "squares", "cubes", "at_zero", "at_full_scale"):
            assert np.array_equal(getattr(some, name), getattr(every, name)), name


@pytest.mark.parametrize("n_threads", [1, 2, 3, 7])
def test_threads_share_the_pixels_without_changing_a_sum(n_threads: int) -> None:
    dn = drawn((21, 6001), np.uint16, 4095)
    taps = (np.arange(6001) % 3).astype(np.uint8)
    alone, wanted = PixelAccumulator(taps, 4095), accumulated(dn, 4095).sums
    alone.add(dn)
    with ThreadPoolExecutor(2) as pool:
        shared = PixelAccumulator(taps, 4095, pool=pool, n_threads=n_threads)
        shared.add(dn)
    assert np.array_equal(shared.sums.cubes, wanted.cubes)
    assert np.array_equal(shared.frame_sums, alone.frame_sums)
    assert np.allclose(shared.chunk_squares, alone.chunk_squares, rtol=1e-12, atol=0)


def test_frames_and_chunks_are_summed_tap_by_tap() -> None:
    dn = drawn((19, 4100), np.uint16, 16383)
    taps = (np.arange(4100) // 7 % 4).astype(np.uint8)
    accumulator = PixelAccumulator(taps, 16383)
    accumulator.add(dn[:11])
    accumulator.add(dn[11:])
    assert accumulator.chunk_sizes.tolist() == [8, 3, 8]
    for tap in range(4):
        own = dn[:, taps == tap].astype(np.float64)
        assert np.array_equal(accumulator.frame_sums[:, tap], own.sum(axis=1))
        chunks = [own[:8], own[8:11], own[11:]]
        squares = [float(((c - c.mean(axis=0)) ** 2).sum()) for c in chunks]
        assert np.allclose(accumulator.chunk_squares[:, tap], squares, rtol=1e-12, atol=0)


def test_one_frame_has_no_variance_and_two_no_third_moment() -> None:
    one, two = (central_moments(accumulated(np.full((n, 3), 7, np.uint16)).sums) for n in (1, 2))
    assert np.isnan(one.variance_dn2).all()
    assert np.isnan(one.third_dn3).all()
    assert (two.variance_dn2 == 0).all()
    assert np.isnan(two.third_dn3).all()
    assert np.isnan(central_moments(PixelSums.zero(3)).mean_dn).all()


def test_the_codes_are_left_alone() -> None:
    dn = drawn((20, 20), np.uint16, 4095)
    dn.flags.writeable = False
    accumulated(dn)


@pytest.mark.parametrize("n_frames", [1, 2, 3, 40])
def test_moments_in_the_memory_of_the_sums_are_the_same(n_frames: int) -> None:
    dn = drawn((n_frames, 70_000), np.uint16, 16383)
    accumulator, kept = accumulated(dn, 16383), accumulated(dn, 16383)
    expected = central_moments(kept.sums)
    sums, moments = accumulator.finished()
    for name in ("mean_dn", "variance_dn2", "third_dn3"):
        assert np.array_equal(getattr(moments, name), getattr(expected, name), equal_nan=True)
    assert np.array_equal(sums.at_zero, kept.sums.at_zero)
    assert np.array_equal(sums.at_full_scale, kept.sums.at_full_scale)
    assert sums.n_frames == n_frames
