"""The level of a spectrum of lines that wander, against series that are drawn."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.stats import poisson

from calib.diagnosis.statistics.exponential_sums import log_chance
from calib.diagnosis.statistics.smooth_level import smooth_level
from calib.diagnosis.statistics.tones import SIGNIFICANT, SLOW

Floats = NDArray[np.float64]

LINES, BLOCKS, DRAWS = 60, 6, 150
WEIGHTS = np.ones(BLOCKS)


def stacked(kept: float, tone: float, rng: Generator) -> Floats:
    """Return the powers of blocks whose lines keep a share, and hold a tone, by frequency."""
    fresh = rng.standard_normal((BLOCKS, LINES + 100))
    lines = lfilter([1.0], [1.0, -kept], fresh)[:, 100:]
    lines = lines + tone * np.sin(2.0 * np.pi * 0.1 * np.arange(LINES))
    lines = lines - lines.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.fft(lines, 2 * LINES)[:, :LINES]) ** 2 / LINES
    floor = np.median(power[:, ::2], axis=1, keepdims=True) / np.log(2.0)
    return np.asarray((power / floor).sum(axis=0))


def stands_out(column: Floats) -> bool:
    """Return whether the highest place does, as it is told of what all columns have in common."""
    level = column.copy()
    level[:SLOW] = level[1 - SLOW :] = 0.0
    k = int(np.argmax(level))
    height = column[k] / max(smooth_level(column, WEIGHTS, k, SLOW), 1.0)
    return -2.0 * (log_chance(height, WEIGHTS) + np.log(LINES)) > SIGNIFICANT


@pytest.mark.parametrize("kept", [0.0, 0.6])
def test_lines_that_wander_have_no_peak(kept: float) -> None:
    rng = default_rng()
    found = sum(stands_out(stacked(kept, 0.0, rng)) for _ in range(DRAWS))
    # By chance one in 1,800. Of 1,000 that keep 0.6 there were 12, for errors of the level; told
    # from the median of what is about a place, one in five.
    assert found <= poisson.isf(1e-5, 0.012 * DRAWS)


@pytest.mark.parametrize("kept", [0.0, 0.6])
def test_a_tone_stands_out_of_lines_that_wander(kept: float) -> None:
    rng = default_rng()
    # Of amplitude 1.2 in noise of 1 in each line: 60 / 4 x 1.44 = 22 times the level, if white.
    assert all(stands_out(stacked(kept, 1.2, rng)) for _ in range(20))
