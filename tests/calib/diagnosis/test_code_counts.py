"""Codes that are counted by the hundred and by the hundred thousand, and are all as wide."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.baseline.code_counts import CodeCounts

ROUGHNESS = -3
"""Where it stands among the numbers, before the two of the lowest code."""


def drawn(most: float, uneven: float = 0.0) -> float:
    """The roughness of codes of which each is expected up to `most` times."""
    rng, code = default_rng(), np.arange(1024)
    expected = most * np.exp(-0.5 * ((code - 500.0) / 150.0) ** 2)
    widths = 1.0 + uneven * rng.standard_normal(len(code))
    counts = CodeCounts(rng.poisson(expected * widths).astype(float), expected)
    return float(counts.whitened(counts.residual())[ROUGHNESS])


@pytest.mark.parametrize("most", [3e2, 1e4, 1e6])
def test_codes_that_are_all_as_wide_are_neither_rough_nor_too_smooth(most: float) -> None:
    # In standard deviations that are no less than its own.
    assert abs(drawn(most)) < 4.5


@pytest.mark.parametrize("most", [1e4, 1e6])
def test_codes_that_are_wide_and_narrow_are_rough(most: float) -> None:
    assert drawn(most, uneven=0.05) > 10.0


def test_codes_that_never_come_are_a_comb_too() -> None:
    code = np.arange(1024)
    expected = 1e4 * np.exp(-0.5 * ((code - 500.0) / 150.0) ** 2)
    counts = CodeCounts(expected * 2.0 * (code % 2), expected)
    np.testing.assert_allclose(counts.comb(2), [0.0, 2.0], atol=1e-3)
