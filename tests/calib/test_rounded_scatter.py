"""The table of how variances of rounded samples scatter, against drawn samples."""

import numpy as np
import pytest

from calib.rounded_scatter import restored_scatter, rounded_scatter
from calib.rounding import rounded_moments, typical_variance, unrounded_mean

N_CELLS, N_LINES = 40_000, 48


@pytest.mark.parametrize("sigma", [0.1, 0.17, 0.25, 0.3, 0.5])
def test_variances_scatter_as_the_table_says(sigma: float) -> None:
    """The variance of N normal numbers is known to sqrt(2/N); these have heavier tails."""
    rng = np.random.default_rng()
    phase = 20.0 + rng.random(N_CELLS)
    codes = np.rint(phase + sigma * rng.standard_normal((N_LINES, N_CELLS)))
    seen = codes.var(axis=0, ddof=1)
    each = np.full(N_CELLS, sigma)
    typical, found = typical_variance(each[:1])[0], rounded_scatter(each[:1])
    spread, fourth = found.variance_spread_dn4[0], found.fourth_cumulant_dn4[0]
    own = 2 * (typical**2 + spread) / (N_LINES - 1) + fourth / N_LINES
    square = (seen - typical) ** 2
    chance = 4 * square.std() / np.sqrt(N_CELLS)
    assert abs(square.mean() - own - spread) < chance
    if sigma < 0.25:
        return
    at = unrounded_mean(codes.mean(axis=0), each).mean_dn
    left = seen - rounded_moments(at, each).variance_dn2
    bias = restored_scatter(phase, each).bias_dn2.mean() / N_LINES
    # Terms beyond the second order in 1/n: a fifth of the second at σ = 0.25.
    assert abs(left.mean() - bias) < 4 * left.std() / np.sqrt(N_CELLS) + 0.25 * abs(bias)
    expected = own + found.restored_dn4[0] / N_LINES
    chance = 4 * ((left - bias) ** 2).std() / np.sqrt(N_CELLS)
    assert abs(left.var() - expected) < chance + 0.1 * expected


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.5])
def test_the_bias_is_that_of_the_phase(phase: float) -> None:
    rng, sigma = np.random.default_rng(), 0.3
    codes = np.rint(20.0 + phase + sigma * rng.standard_normal((N_LINES, N_CELLS)))
    each = np.full(N_CELLS, sigma)
    at = unrounded_mean(codes.mean(axis=0), each).mean_dn
    left = codes.var(axis=0, ddof=1) - rounded_moments(at, each).variance_dn2
    bias = restored_scatter(np.array([phase]), each[:1]).bias_dn2[0] / N_LINES
    # Third order: some 20 % of the second at whole codes.
    assert abs(left.mean() - bias) < 4 * left.std() / np.sqrt(N_CELLS) + 0.25 * abs(bias)


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.5, None])
def test_the_share_is_what_a_variance_at_a_given_mean_code_moves_by(phase: float | None) -> None:
    sigma, step = 0.28, 2e-3
    phases = 20.0 + (np.arange(400) / 400 if phase is None else np.full(400, phase))
    each = np.full(400, sigma)
    codes = rounded_moments(phases, each).mean_dn

    def at_the_code(tried: float) -> float:
        tries = np.full(400, tried)
        at = unrounded_mean(codes, tries).mean_dn
        return float(rounded_moments(at, tries).variance_dn2.mean())

    def average(tried: float) -> float:
        return float(typical_variance(np.array([tried]))[0])

    rise = at_the_code(sigma + step) - at_the_code(sigma - step)
    share = rise / (average(sigma + step) - average(sigma - step))
    assert restored_scatter(phases, each).share_of_rise.mean() == pytest.approx(share, abs=0.01)
    if phase is None:
        assert rounded_scatter(each).share_of_rise[0] == pytest.approx(share, abs=0.01)


def test_much_noise_scatters_as_a_normal_signal() -> None:
    found = rounded_scatter(np.array([1.3]))
    assert abs(found.variance_spread_dn4[0]) < 1e-12
    assert found.share_of_rise[0] == pytest.approx(1.0, abs=1e-6)
    assert abs(found.fourth_cumulant_dn4[0] + 1 / 120) < 1e-4
