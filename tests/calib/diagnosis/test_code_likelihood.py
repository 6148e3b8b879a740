"""Counts of single codes: a weak comb is told from chance, and from noise of another shape."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.diagnosis.baseline.code_likelihood import CodeLikelihood, Floats

CODE = np.arange(512.0)
COMB = np.where(CODE % 2 == 0, 1.0, -1.0)
NOISE = {0: 1.2, 1: 12.0}
SIGMA = 4.5
"""Chance exceeds it once in 100,000 draws."""


def peak(mean: float, noise: float) -> Floats:
    density = np.exp(-0.5 * ((CODE - mean) / noise) ** 2)
    return np.asarray(2e5 * density / density.sum())


EXPECTED = {0: peak(60.0, 1.2), 1: peak(300.0, 12.0)}
LIKELIHOOD = CodeLikelihood(EXPECTED, NOISE)
WHOLE = EXPECTED[0] + EXPECTED[1]


def seen(rng: Generator, widths: Floats) -> Floats:
    return np.asarray(rng.poisson(WHOLE * widths) - WHOLE)


@pytest.mark.parametrize("width", [0.0, 0.015, 0.05])
def test_a_comb_explains_what_its_samples_are_worth(width: float) -> None:
    found = LIKELIHOOD.explained(seen(default_rng(), 1.0 + width * COMB), COMB * WHOLE)
    # Of N samples, width^2 N in deviance: errors of the narrow peak's shape take little of it.
    assert abs(np.sqrt(found) - width * np.sqrt(WHOLE.sum())) < SIGMA + 0.1 * width * 632.0


def test_a_peak_that_is_shifted_and_wider_is_no_comb() -> None:
    rng = default_rng()
    other = peak(60.05, 1.24) + peak(300.5, 12.4)
    off = rng.poisson(other) - WHOLE
    assert off @ (off / np.maximum(WHOLE, 1.0)) > 400.0
    assert LIKELIHOOD.explained(off, COMB * WHOLE) < SIGMA**2


def test_widths_of_their_own_explain_what_no_comb_does() -> None:
    rng = default_rng()
    wide = seen(rng, 1.0 + 0.1 * rng.standard_normal(len(CODE)))
    assert LIKELIHOOD.of_any_widths(wide) > LIKELIHOOD.explained(wide, COMB * WHOLE)
    assert LIKELIHOOD.of_any_widths(seen(rng, np.ones(len(CODE)))) < SIGMA**2
