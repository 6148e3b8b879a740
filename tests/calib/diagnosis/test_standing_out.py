"""Pixels that stand out: what is recorded and what is simulated stand on one scale."""

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.standing_out import FAR_SIGMA, held_slopes
from calib.forward.effects.exposure_offset import ExposureOffset
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS = 384


def test_simulated_misfits_are_what_recorded_ones_are_on_average() -> None:
    rng = default_rng()
    evidence = recorded(plain_model(COLUMNS), plan(rng, 60, twice=2), rng)
    std = np.sqrt(evidence.baseline.variance_dn2.reshape(evidence.n_blocks, -1) / 60)
    ramp = np.linspace(0.0, 40.0, COLUMNS) * std
    one = [ramp * (np.arange(len(std)) == b)[:, None] for b in range(len(std))]
    # Of a block that stands alone, an offset or a slope takes the most.
    shift = max(one, key=lambda each: evidence.misfit(each, observed=False).max())
    told = evidence.misfit(shift, observed=False)
    seen = evidence.misfit(shift + evidence.observed_means, observed=True)
    assert told.max() > FAR_SIGMA
    used = evidence._misfits.used
    # Of a noncentral chi-squared, of variance 2 (used + 2 shift^2), through the cube root.
    spread = 2.0 / (9.0 * used)
    ratio = (1.0 + told * np.sqrt(spread)) ** 3
    scatter = np.sqrt(2.0 * (2.0 * ratio - 1.0) / used) * ratio ** (-2.0 / 3.0) / 3.0
    z = (seen - told) / (scatter / np.sqrt(spread))
    # The cube root's curvature is worth a tenth of a standard deviation at most.
    assert abs(z.mean()) < 0.1 + 5.0 / np.sqrt(COLUMNS)
    assert abs(z.std() - 1.0) < 5.0 / np.sqrt(2 * COLUMNS)


def test_one_pixel_that_passes_a_limit_is_no_steep_slope() -> None:
    about = np.array([11.9, 0.0, 0.0])
    jump = np.array([0.0, 54.0, -1.0])
    # An effect as strong as it is: a count of 5.4 on the way from nothing.
    held = held_slopes(jump, np.array([5.4, 5.4, 5.4]), about, about)
    np.testing.assert_allclose(held, [0.0, 5.4, -1.0])
    np.testing.assert_allclose(held_slopes(jump, np.abs(jump), about, 0.0 * about), jump)


def test_what_moves_all_pixels_leaves_none_of_them_out() -> None:
    # Means of the typical pixel miss by 4 standard deviations. Those beyond 6 are those that chance
    # moved the same way: what is left of the effect without them would be too weak.
    rng = default_rng()
    found = recorded(plain_model(256), plan(rng, 100, twice=0), rng, [ExposureOffset(1.3)])
    assert found.sensor.noisy == ()
