"""Mechanisms of the electronics, the converter and the link."""

from collections.abc import Sequence

import numpy as np
import pytest

from tests.concealed.bench import drawn, level_sensor, scan_of
from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.codes import (
    AdcDnl,
    BlackClip,
    DuplicatedLines,
    StuckBit,
)
from tests.concealed.generator.mechanisms.electronics import (
    Banding,
    HeavyTailedNoise,
    LineNoise,
    RtsPixels,
)
from tests.concealed.generator.mechanisms.unlisted_volts import LinkErrors
from tests.concealed.generator.mechanisms.volts import InterpixelCapacitance, TapCrosstalk

N = 4000


def acted(
    one: Mechanism, signal: np.ndarray, layout: str = "single", rows: int = 1, seed: int = 1
) -> np.ndarray:
    scan = scan_of(level_sensor(rows=rows, layout=layout), len(signal))
    return np.asarray(one.act(signal, scan, {}, np.random.default_rng(seed)))


@pytest.mark.parametrize("rows", [1, 8])
@pytest.mark.parametrize("shape", [*InterpixelCapacitance.shapes, *InterpixelCapacitance.foreign])
def test_capacitance_keeps_the_sum_of_the_voltages(shape: str, rows: int) -> None:
    volts = np.random.default_rng(2).normal(1000.0, 30.0, (50, rows, 64))
    coupled = acted(InterpixelCapacitance(0.02, shape), volts, rows=rows)
    np.testing.assert_allclose(coupled.sum(axis=(1, 2)), volts.sum(axis=(1, 2)))


def test_capacitance_correlates_neighbours_by_twice_its_coefficient() -> None:
    """Of white noise: C01/C00 = (2c(1 − 2c)) / ((1 − 2c)² + 2c²)."""
    c, volts = 0.02, np.random.default_rng(3).normal(0.0, 30.0, (N, 1, 64))
    inner = acted(InterpixelCapacitance(c, "nearest"), volts)[..., 1:-1]
    product = inner[..., 1:] * inner[..., :-1]
    expected = 900.0 * 2 * c * (1 - 2 * c)
    assert abs(product.mean() - expected) < 4 * product.std() / np.sqrt(product.size)
    spread = 900.0 * np.sqrt(2 / inner.size)
    assert abs(inner.var() - 900.0 * ((1 - 2 * c) ** 2 + 2 * c**2)) < 4 * spread


def test_crosstalk_comes_from_the_column_that_is_read_at_the_same_moment() -> None:
    dn = np.zeros((3, 1, 64))
    dn[..., 10] = 1000.0
    seen = acted(TapCrosstalk(0.01, "mutual"), dn, "odd_even")
    assert seen[0, 0, 11] == pytest.approx(10.0)
    assert seen[0, 0, 10] == pytest.approx(1000.0)
    assert np.count_nonzero(seen[0]) == 2


@pytest.mark.parametrize("shape", [*LineNoise.shapes, "two_valued", "wandering"])
def test_line_noise_moves_a_line_as_a_whole(shape: str) -> None:
    lines = acted(LineNoise(2.0, shape), np.zeros((N, 1, 64)))
    np.testing.assert_array_equal(lines, np.broadcast_to(lines[..., :1], lines.shape))
    correlated = (1 + 0.6**2) / (1 - 0.6**2) if shape == "wandering" else 1.0
    assert abs(lines[:, 0, 0].var() - 4.0) < 4 * 4.0 * np.sqrt(2 * correlated / N)


def test_a_tone_has_half_its_squared_amplitude() -> None:
    tone = acted(Banding(3.0, "sine", 7.31, 0.4), np.zeros((N, 1, 64)))
    assert tone.var() == pytest.approx(4.5, rel=1e-3)


def test_a_pixel_of_two_levels_is_up_as_often_as_its_chances_say() -> None:
    up, down = 0.1, 0.3
    rts = RtsPixels(5.0, "two_levels", np.array([7]), np.array([up]), np.array([down]))
    signal = acted(rts, np.zeros((20_000, 1, 64)))
    course = signal[:, 0, 7] / 5.0
    share, memory = up / (up + down), 1 - up - down
    spread = np.sqrt(share * (1 - share) * (1 + memory) / (1 - memory) / len(course))
    assert set(np.unique(course)) == {0.0, 1.0}
    assert abs(course.mean() - share) < 4 * spread
    assert np.count_nonzero(signal[:, 0]) == np.count_nonzero(course)


@pytest.mark.parametrize("shape", ["mixture", "laplace"])
def test_tails_have_the_variance_of_what_is_mixed_in(shape: str) -> None:
    share, other = 0.02, 36.0 if shape == "mixture" else 32.0
    noise = 10.0 * np.random.default_rng(5).standard_normal((N, 1, 64))
    tailed = acted(HeavyTailedNoise(share, shape), noise) / 10.0
    squares = tailed**2
    spread = squares.std() / np.sqrt(squares.size)
    assert abs(squares.mean() - (1 - share + share * other)) < 4 * spread


@pytest.mark.parametrize("shape", ["alternating", "every_fourth"])
def test_wide_codes_leave_the_mean_of_a_wide_signal(shape: str) -> None:
    dn = np.random.default_rng(6).uniform(1000.5, 1400.5, (N, 1, 64))
    codes = acted(drawn(AdcDnl, 0.4, shape, level_sensor()), dn)
    period = 2 if shape == "alternating" else 4
    counts = np.bincount(codes.ravel(), minlength=1401)[1001:1400].astype(float)
    wide = counts[(np.arange(1001, 1400) % period) == 0].mean()
    narrow = counts[(np.arange(1001, 1400) % period) != 0].mean()
    error = codes - dn
    assert abs(error.mean()) < 4 * error.std() / np.sqrt(error.size)
    # Edge k moves by half the strength up where k is even: even codes gain, odd ones lose it.
    expected = {"alternating": 1.4 / 0.6, "every_fourth": 1.4 / ((4 - 1.4) / 3)}[shape]
    assert abs(wide / narrow / expected - 1) < 4 * np.sqrt(2 / (wide * 99))


def test_a_stuck_bit_is_the_only_one_that_changes() -> None:
    codes = np.random.default_rng(7).integers(0, 4096, (200, 1, 64))
    for shape, value in (("to_one", 1), ("to_zero", 0)):
        stuck = acted(StuckBit(1.0, shape, 2), codes)
        assert np.all((stuck >> 2) & 1 == value)
        np.testing.assert_array_equal(stuck & ~4, codes & ~4)


def test_the_black_level_cuts_off_the_share_that_it_is_named_for() -> None:
    clip = drawn(BlackClip, 0.3, "hard", level_sensor())
    sigma = np.hypot(10.0 * 0.2, np.sqrt(1 / 12))
    dn = 200.0 + sigma * np.random.default_rng(8).standard_normal((N, 1, 64))
    below = np.mean(np.rint(dn) < clip.black_dn)  # type: ignore[attr-defined]
    assert acted(clip, np.rint(dn).astype(int)).min() == clip.black_dn  # type: ignore[attr-defined]
    # The share is known from 256 reads of 64 pixels.
    assert abs(below - clip.strength) < 4 * np.sqrt(0.25 / (256 * 64))


@pytest.mark.parametrize("shape", ["whole", "pairs"])
def test_a_line_that_is_sent_twice_pushes_the_others_back(shape: str) -> None:
    lines = np.arange(500)[:, np.newaxis, np.newaxis] * np.ones((1, 1, 64), dtype=int)
    sent = acted(DuplicatedLines(0.05, shape), lines)[:, 0, 0]
    assert len(sent) == 500
    assert set(np.unique(np.diff(sent))) == ({0, 1} if shape == "whole" else {-1, 1})
    twice = 500 - len(np.unique(sent))
    assert 0 < twice < 500 * 0.05 * (1 if shape == "whole" else 2) * 2


def test_swapped_bits_keep_their_number() -> None:
    codes = np.random.default_rng(9).integers(0, 16_384, (N, 1, 64))
    sent = acted(LinkErrors(1.0, "plain", 5), codes)
    ones: Sequence[np.ndarray] = [np.bitwise_count(each) for each in (codes, sent)]
    np.testing.assert_array_equal(ones[0], ones[1])
    differ = ((codes >> 5) ^ (codes >> 6)) & 1
    chance = (codes / 16_383 * differ).sum()
    assert abs((sent != codes).sum() - chance) < 4 * np.sqrt(chance)
