"""What stands out of spectra: none of it by chance, and all of a tone's power is there to stand."""

from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.stats import gamma

from calib.diagnosis.evidence import tone_scale
from calib.diagnosis.evidence.tone_scale import ToneScale
from calib.diagnosis.statistics import tones
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.diagnosis.statistics.exponential_sums import log_chance
from calib.diagnosis.statistics.off_place import places_beside
from calib.diagnosis.statistics.spectrum import power_spectrum

LINES, COLUMNS, READ_DN2 = 40, 96, 4.0
SIGNAL = np.array([0.0, 0.0, 50.0, 100.0, 300.0, 1000.0])


@dataclass(frozen=True)
class Block:
    """What is looked at for peaks."""

    power: NDArray[np.float32]
    mean_dn: NDArray[np.float64]
    spectrum_lines: int = LINES


def block(residual: NDArray[np.float64]) -> Block:
    residual = residual - residual.mean(axis=0)
    far = np.full(COLUMNS, np.inf)
    return Block(power_spectrum(residual, np.zeros(COLUMNS), far), np.zeros((1, COLUMNS)))


def blocks(cycles: float, amplitude_dn: float, rng: np.random.Generator) -> list[BlockSums]:
    """Return blocks with a tone of `cycles` a line, at another phase in each."""
    turns = cycles * np.arange(LINES * COLUMNS).reshape(LINES, COLUMNS) / COLUMNS
    found = [
        block(
            np.sqrt(READ_DN2 + 0.2 * signal) * rng.standard_normal((LINES, COLUMNS))
            + amplitude_dn * np.sin(2 * np.pi * (turns + rng.random()))
        )
        for signal in SIGNAL
    ]
    return cast("list[BlockSums]", found)


@pytest.mark.parametrize(("n", "n_pixels"), [(7, 16), (8, 15), (5, 9)])
def test_power_is_that_of_a_tone_through_all_samples_in_turn(n: int, n_pixels: int) -> None:
    rng = default_rng()
    samples = rng.standard_normal((n, n_pixels))
    power = power_spectrum(samples, np.zeros(n_pixels), np.full(n_pixels, np.inf))
    time = np.arange(n * n_pixels) / n_pixels
    own = samples - samples.mean(axis=1, keepdims=True)
    for k, c in [(k, c) for k in range(2 * n) for c in range(power.shape[1])]:
        f = (k / (2 * n) + 0.5) % 1.0 - 0.5
        # What a line's pixels have in common stands in one column, and in no other.
        at, seen = (time, own) if c else (np.floor(time), samples)
        direct = abs(np.exp(-2j * np.pi * (c + f) * at) @ seen.ravel()) ** 2 / samples.size
        # Single precision, 6e-8, over a hundred terms.
        assert power[k, c] == pytest.approx(direct, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("of", [1, 2, 18])
def test_a_sum_of_alike_exponential_variables_is_gamma_s(of: int) -> None:
    for x in (2.0 * of + 2.0, 4.0 * of + 20.0):
        # The saddlepoint's own error: 4 % of the probability far out, for one variable.
        assert log_chance(x, np.ones(of)) == pytest.approx(gamma.logsf(x, of), abs=0.05)


def test_a_sum_of_unlike_exponential_variables_dies_away_with_the_largest() -> None:
    w = np.array([1.0, 0.5, 0.1])
    share = [np.prod([a / (a - b) for b in w if b != a]) for a in w]
    for x in (3.0, 10.0, 30.0):
        exact = np.log(np.sum(share * np.exp(-x / w)))
        assert log_chance(x, w) == pytest.approx(exact, abs=0.05)


def test_chance_makes_peaks_no_more_often_than_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    often = 6.0  # exp(-often / 2) of the four searches have a peak, at the most
    monkeypatch.setattr(tones, "SIGNIFICANT", often)
    rng, runs = default_rng(), 200
    found = sum(bool(tones.find_peaks(blocks(0.0, 0.0, rng), SIGNAL)) for _ in range(runs))
    most = runs * 4.0 * np.exp(-often / 2.0)
    assert found < most + 3.0 * np.sqrt(most)
    # Padding counts each frequency twice, and peaks of two searches may be one.
    assert found > most / 4.0 - 3.0 * np.sqrt(most / 4.0)


@pytest.mark.parametrize("cycles", [17.0 + 10.5 / LINES, 17.5 + 0.25 / LINES, 30.2])
def test_a_tone_is_found_wherever_it_lies_between_columns_frequencies(cycles: float) -> None:
    # Twice its deviance is N a^2 / v, summed: 2 x 50 in the darkest two blocks alone.
    amplitude = np.sqrt(100.0 * READ_DN2 / (LINES * COLUMNS))
    rng, runs, found = default_rng(), 12, 0
    for _ in range(runs):
        peaks = tones.find_peaks(blocks(cycles, amplitude, rng), SIGNAL)
        near = [p for p in peaks if abs(p.cycles_along + p.cycles_per_line - cycles) < 1 / LINES]
        found += bool(near)
    assert found >= runs - 2


def alone(seen: NDArray[np.float64]) -> ToneScale:
    """Return the scale of one tone in as many blocks, whose power scatters by 1 without it."""
    return ToneScale(seen[:, None], np.ones((len(seen), 1)))


@pytest.mark.parametrize("over_noise", [0.0, 0.5, 2.0, 20.0, 200.0])
def test_tones_scatter_by_1_at_the_most_about_where_they_stand(
    over_noise: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tone_scale, "TONE_ERROR", 0.0)
    n = 4000
    amplitude = default_rng().normal((np.sqrt(2.0 * over_noise), 0.0), 1.0, (n, 2))
    scale = alone((amplitude**2).sum(axis=1) / 2.0 - 1.0)
    z = scale.whitened(scale.observed_dn2) - scale.whitened(np.full((n, 1), over_noise))
    # To second order it would scatter by 1 everywhere, and by 1.04 it does most.
    assert 0.6 < z.std() < 1.05 + 4.0 / np.sqrt(2.0 * n)
    assert abs(z.mean()) < 0.06 + 4.0 / np.sqrt(n)


@pytest.mark.parametrize("along", [0, 7])
def test_a_tone_between_two_places_is_put_where_it_lies(along: int) -> None:
    rng = default_rng()
    line = int(rng.integers(5, LINES // 2 - 5)) + float(rng.uniform(-0.25, 0.25))
    lines, pixels = np.arange(LINES)[:, None], np.arange(COLUMNS) / COLUMNS
    turns = line / LINES * (lines + (pixels if along else 0.0)) + along * pixels
    found = [
        block(rng.standard_normal((LINES, COLUMNS)) + np.sin(2 * np.pi * (turns + rng.random())))
        for _ in SIGNAL
    ]
    (peak, *_) = tones.find_peaks(cast("list[BlockSums]", found), SIGNAL)
    assert peak.cycles_along == along
    over_noise = len(SIGNAL) * LINES * COLUMNS / 4.0
    off = (peak.cycles_per_line + peak.between) * LINES - line
    # Chance, and what a line's mean takes from a tone that runs through its pixels.
    assert abs(off) < 5.0 * 0.39 / np.sqrt(over_noise) + 0.01
    share = np.mean(peak.squared_amplitude_dn2)
    assert share == pytest.approx(peak.share_seen(LINES), abs=0.02 + 6.0 / np.sqrt(over_noise))


def test_frequencies_beyond_the_last_are_the_next_columns_first() -> None:
    shape = (8, 5)
    assert places_beside(4, 2, shape) == ((3, 1), (5, 2))
    assert places_beside(3, 2, shape) == ((2, 2), (4, 3))
    assert places_beside(0, 2, shape) == ((7, 2), (1, 2))
    assert places_beside(0, 0, shape) == ((7, 0), (1, 0))
    assert places_beside(3, 4, shape) == ((2, 4), (4, 4))


def test_a_tone_that_grows_moves_as_the_derivative_says() -> None:
    rng = default_rng()
    scale = ToneScale(rng.uniform(0.0, 30.0, (6, 2)), rng.uniform(0.5, 2.0, (6, 2)))
    about, change, small = rng.uniform(0.0, 30.0, (6, 2)), rng.uniform(1.0, 9.0, (6, 2)), 1e-5
    kept = np.arange(6) != 2
    moved = scale.whitened(about + small * change, kept) - scale.whitened(about, kept)
    slope = scale.derivative(change, about, kept)
    np.testing.assert_allclose(moved / small, slope, rtol=1e-3, atol=1e-9)
    assert (slope.reshape(6, 2)[2] == 0.0).all()
    assert (slope.reshape(6, 2)[kept] > 0.0).all()
