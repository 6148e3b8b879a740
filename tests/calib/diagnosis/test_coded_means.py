from dataclasses import replace

import numpy as np
from numpy.random import default_rng
from scipy.stats import norm

from calib.diagnosis.simulation.chain_run import FittedChain
from calib.diagnosis.simulation.coded_means import NODES, coded_means, moved_by_codes
from calib.forward.effects.adc_inl import AdcInl
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.stuck_bit import StuckBit
from tests.calib.diagnosis.recordings import plain_model, plan, recorded


def fitted_chain() -> FittedChain:
    rng = default_rng()
    evidence = recorded(plain_model(64), plan(rng, 20), rng)
    return FittedChain(evidence.baseline, evidence.table, evidence.sensor)


def test_a_stop_raises_means_by_what_the_normal_distribution_has_below_it() -> None:
    chain, level, std = fitted_chain(), 60, 3.0
    mean = np.linspace(56.0, 70.0, 64)
    moved = coded_means(
        chain,
        (BlackClip(level),),
        chain.table.at(0, np.zeros(1)),
        mean,
        np.full(64, std**2 + 1 / 12),
    )
    below = (level - mean) / std
    expected = std * (below * norm.cdf(below) + norm.pdf(below))
    # Quantiles leave out what lies beyond the last of them.
    np.testing.assert_allclose(moved, expected, atol=2.0 * std / NODES)


def test_a_bit_that_always_sticks_sets_it_and_moves_nothing_else() -> None:
    chain = fitted_chain()
    mean = np.full(64, 64.0)
    mean[32:] = 72.0
    moved = coded_means(
        chain, (StuckBit(1.0, 3, 1),), chain.table.at(0, np.zeros(1)), mean + 3.5, np.full(64, 0.2)
    )
    np.testing.assert_allclose(moved, np.where(mean == 64.0, 8.0, 0.0), atol=0.01)


def test_a_smooth_error_moves_means_by_itself_averaged_over_the_noise() -> None:
    # The mean of sin(k x) over noise of standard deviation s in x is exp(-k^2 s^2 / 2) sin(k x).
    chain, std = fitted_chain(), 40.0
    mean = np.linspace(500.0, 3500.0, 64)
    moved = coded_means(
        chain, (AdcInl(0.0, 2.0, 0.0),), chain.table.at(0, np.zeros(1)), mean,
        np.full(64, std**2 + 1 / 12),
    )  # fmt: skip
    x, spread = 2.0 * np.pi * mean / 4095.0, 2.0 * np.pi * std / 4095.0
    # Quantiles of equal weight have a variance that is short by a share of about 1 / n.
    expected = 2.0 * np.sin(x) * np.exp(-(spread**2) / 2.0)
    np.testing.assert_allclose(moved, expected, atol=2.0 * spread**2 / 2.0)


def test_blocks_that_go_together_are_moved_as_each_alone() -> None:
    chain, rng = fitted_chain(), default_rng()
    moved = rng.normal(0.0, 5.0, chain.baseline.mean_dn[:, 0].shape)
    variance = np.array(chain.baseline.variance_dn2)
    # Noise that averages rounding out, and noise that does not.
    variance[::2] = 0.3
    chain = replace(chain, baseline=replace(chain.baseline, variance_dn2=variance))
    for effect in (StuckBit(1.0, 3, 1), AdcInl(0.0, 2.0, 0.0)):
        alone = [
            coded_means(chain, (effect,), chain.table.at(b, np.zeros(1)), mean + more, v)
            for b, (mean, more, v) in enumerate(
                zip(chain.baseline.mean_dn[:, 0], moved, variance[:, 0], strict=True)
            )
        ]
        np.testing.assert_array_equal(moved_by_codes(chain, (effect,), moved), np.stack(alone))
