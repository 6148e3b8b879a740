from math import exp

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from scipy.special import gammaln, logsumexp
from scipy.stats import norm

from calib.arrays import Lines
from calib.diagnosis.naming.search import THRESHOLD
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.shapes.far_credit import FarCredit, far_credit
from calib.diagnosis.shapes.far_events import log_density
from calib.diagnosis.shapes.far_likelihood import most_likely
from calib.diagnosis.statistics.far_samples import LEAST_SIGMA
from calib.diagnosis.statistics.gather import block_sums
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.recording.header import CameraHeader
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

SAMPLES = 1e5
WIDE = 6.0


def test_the_noise_of_a_pixel_is_told_without_the_sample_that_lies_out() -> None:
    lines = np.rint(default_rng().normal(300.0, 3.0, (30, 1, 64))).astype(np.uint16)
    lines[12, 0, 20], lines[12, 0, 21] = 345, 338
    far = block_sums(lines, Sensor(CameraHeader(columns=64, bit_depth=12)), 1 << 16).far
    # The farthest of those side by side stands for both.
    assert far.pixel.tolist() == [20]
    others = np.delete(lines[:, 0, 20], 12).astype(float)
    # Held at the middle of the variances of the pixels about it, unless it is beyond them by
    # 4 standard errors, sqrt(2 / 30) each; the middle of 8 is known to 1.25 / sqrt(8) of that.
    error = np.sqrt(2.0 / 30.0)
    assert abs(far.variance_dn2[0] / 9.0 - 1.0) < 5.0 * error
    # The means of pixel and line are off by 3 / sqrt(30) and 3 / sqrt(64), and hits in the line's.
    assert abs(far.off_dn[0] - (345.0 - others.mean())) < 5.0 * 3.0 / 8.0 + (45.0 + 38.0) / 64.0
    assert far.beside_dn.shape == (1, 2)


@pytest.mark.parametrize("electrons", [4.0, 20.0, 400.0])
def test_the_density_far_out_is_that_of_shot_and_read_noise(electrons: float) -> None:
    read, gain = 1.5, 2.0
    variance = gain**2 * (electrons + read**2)
    off = np.array([-6.0, -5.0, 5.0, 6.0, 8.0, 10.0]) * np.sqrt(variance)
    count = np.arange(0.0, electrons + 40.0 * np.sqrt(electrons) + 100.0)
    poisson = count * np.log(electrons) - electrons - gammaln(count + 1.0)
    shifted = off[:, None] - gain * (count - electrons)
    exact = logsumexp(poisson + norm.logpdf(shifted, scale=gain * read), axis=1)
    found = log_density(off, np.array(gain), np.array(gain * electrons), np.array(variance))
    # Beyond the first order, descent leaves some part of 1 / (12 n) of a Poisson count of n, which
    # is near 1 where it is tilted far down, and of a tenth for each that read noise smears.
    np.testing.assert_allclose(found, exact, atol=1.0 / 12.0)
    # A Gaussian's tail is off by far more where electrons are few.
    assert abs(norm.logpdf(off[-1], scale=np.sqrt(variance)) - exact[-1]) > 5.0 / 12.0


def _deviance(sizes: np.ndarray) -> float:
    """Return how much likelier tails `WIDE` times as wide make samples that lie out by `sizes`."""
    ratio = np.exp(norm.logpdf(sizes, scale=WIDE) - norm.logpdf(sizes))
    return most_likely(ratio[None], np.array([2.0 * SAMPLES * norm.sf(LEAST_SIGMA / WIDE)]))


def test_chance_is_as_rare_as_a_likelihood_ratio_tells() -> None:
    rng, runs = default_rng(), 4000
    expected = 2.0 * SAMPLES * norm.sf(LEAST_SIGMA)
    found = []
    counts = rng.poisson(expected, runs)
    for n in counts[counts > 0]:
        share = rng.random(n) * norm.sf(LEAST_SIGMA)
        found.append(_deviance(norm.isf(share)))
    # A likelihood ratio of any share beyond x has a chance of 1 / x at most; the best of shares,
    # which go over one decade of events, reaches it some ten times as often.
    chance = 10.0 * exp(-0.5 * THRESHOLD) * runs
    assert sum(d > THRESHOLD for d in found) <= chance + 5.0 * np.sqrt(chance)


def test_two_readings_of_heavy_tails_are_certain_where_their_number_is_not() -> None:
    # Two at nine standard deviations, where 1e5 samples have 2e-14.
    assert _deviance(np.array([9.0, -9.0])) > 3.0 * THRESHOLD


class Raised(HeavyTailedNoise):
    """Readings that only rise: in each its own, whatever the exposure."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        up = np.where(rng.random(signal.shape) < self.share, self.std_e, 0.0)
        return np.asarray(signal + up * rng.exponential(1.0, signal.shape))


def _credit(*effects: Effect, columns: int = 96) -> FarCredit:
    rng = default_rng()
    return far_credit(recorded(plain_model(columns), plan(rng, 100, twice=0), rng, effects))


def test_names_are_credited_with_their_own_samples() -> None:
    # 12 electrons of read noise; some 350 readings six times as noisy, and some 20 tracks.
    tails = _credit(HeavyTailedNoise(share=2e-3, std_e=72.0))
    rays = _credit(CosmicRays(per_pixel_s=0.5, electrons=1000.0))
    clean = _credit()
    assert tails.tails > tails.rays + THRESHOLD
    assert rays.rays > rays.tails + THRESHOLD
    assert clean.tails + clean.rays < THRESHOLD


def test_readings_that_only_rise_are_no_tracks() -> None:
    # Each tells them apart by 0.7 of deviance, of some 130; as tails of both signs, by -4.
    found = _credit(Raised(share=2e-3, std_e=72.0), columns=512)
    assert found.tails > found.rays - THRESHOLD
