"""The covariance as a whole: what weights harmonics with its inverse must not be overconfident."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.mtf.assembly.coarse_alignment import coarse_alignment
from calib.mtf.estimation.joint_fit import joint_fit
from calib.mtf.estimation.sandwich import shrinkage
from calib.mtf.simulation.detector import DetectorNoise
from tests.calib.mtf.simulated import ORDERS_12, SMALL, misaligned, record

DETECTORS = [
    pytest.param(DetectorNoise(read_noise_e=400.0), id="read-noise"),
    pytest.param(DetectorNoise(shot_noise=True, gain_std=0.01), id="shot-noise-and-gain"),
]


@pytest.mark.parametrize("detector", DETECTORS)
def test_all_harmonics_together_scatter_as_their_covariance_says(detector: DetectorNoise) -> None:
    rng, ratios = default_rng(), []
    for _ in range(24):
        case = record(
            rng, (18, 18), scan=SMALL, grating=ORDERS_12, alignment=misaligned(rng, SMALL),
            detector=detector,
        )  # fmt: skip
        fit = joint_fit(case.scan, coarse_alignment(case.scan).alignment)
        away = fit.transfer - case.transfer(fit)
        error = np.concatenate([away.real, away.imag])
        ratios.append(error @ np.linalg.solve(fit.transfer_covariance, error) / len(error))
    # 105 unknowns from 324 pixels: the sandwich alone comes to 1.35. One ratio scatters by 0.17, of
    # 240 recordings; what these few scatter by is small where they are small, and no measure.
    assert abs(np.mean(ratios) - 1) < 5.0 * 0.17 / np.sqrt(24)


def test_what_is_noise_of_a_covariance_is_told_from_what_is_not() -> None:
    rng, n, p = default_rng(), 400, 60
    white = rng.normal(size=(n, p))
    uneven = white * np.linspace(0.1, 3, p)
    by_chance, real = (shrinkage(np.cov(each.T), n) for each in (white, uneven))
    assert by_chance > 0.8
    departure = 9 / 5 - 1  # variance over squared mean of a square that is even on (0.1², 3²)
    assert real == pytest.approx((p + 1 + departure) / n / departure, rel=0.35)


def test_a_multiple_of_the_identity_is_all_noise() -> None:
    assert shrinkage(3 * np.eye(5), 100) == 1.0
