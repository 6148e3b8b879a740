"""What bends a curve is told apart, where the recording tells, and said to be open elsewhere."""

import numpy as np
import pytest

from calib.transfer.photon_transfer.curve_fit import Model
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.result import PhotonTransfer
from calib.transfer.photon_transfer.variance_curve import Shape, exponential_share
from tests.calib.transfer.photon_transfer.simulated import BETA_PER_DN, GAIN, Kind, recording


def measured(kind: Kind, seed: int, shares: tuple[float, ...] | None = None) -> PhotonTransfer:
    rng = np.random.default_rng([seed, 99])
    if shares is None:
        return photon_transfer(recording(kind, 200, 500, rng))
    return photon_transfer(recording(kind, 200, 500, rng, shares))


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    ("kind", "wanted"),
    [
        ("straight", Model.STRAIGHT),
        ("nonlinear", Model.NONLINEAR),
        ("brighter_fatter", Model.BRIGHTER_FATTER),
    ],
)
def test_means_tell_a_bent_response_from_charge_that_repels(
    kind: Kind, wanted: Model, seed: int
) -> None:
    choice = measured(kind, seed).taps[0].choice
    assert choice.with_means
    assert choice.called_for is wanted
    fits = choice.fits
    if wanted is not Model.STRAIGHT:
        other = {Model.NONLINEAR: Model.BRIGHTER_FATTER, Model.BRIGHTER_FATTER: Model.NONLINEAR}
        # Twice the log of the odds by which the other model is worse: e⁵ to 1 and more.
        assert fits[other[wanted]].aicc - fits[wanted].aicc > 10
        assert fits[Model.STRAIGHT].aicc - fits[wanted].aicc > 10


@pytest.mark.parametrize("seed", range(2))
def test_the_response_s_bend_comes_back(seed: int) -> None:
    fit = measured("nonlinear", seed).taps[0].choice.fits[Model.NONLINEAR]
    assert abs(fit.shape.beta_per_dn - BETA_PER_DN) < 4 * fit.std("beta_per_dn")
    assert fit.std("beta_per_dn") < 0.1 * BETA_PER_DN


def test_variances_alone_do_not_name_the_cause() -> None:
    found = measured("nonlinear", 0, (0.1, 0.5, 0.9))
    choice = found.taps[0].choice
    assert not choice.with_means
    assert choice.called_for is Model.QUADRATIC
    assert "would tell" in choice.why


def test_two_flats_say_nothing_of_a_bend() -> None:
    found = measured("straight", 0, (0.2, 0.9))
    assert found.taps[0].choice.used is Model.STRAIGHT
    assert any("no word on its bend" in w for w in found.warnings)
    assert abs(found.system_gain.value - GAIN) < 4 * found.system_gain.std


@pytest.mark.parametrize("beta", [-1e-5, 0.0, 3e-5])
def test_the_straight_signal_is_found_back_from_the_bent_mean(beta: float) -> None:
    shape = Shape(0.25, 9.0, beta_per_dn=beta, a00_per_e=-1e-6)
    x = np.linspace(0.0, 3500.0, 50)
    assert np.allclose(shape.linear(shape.mean(x, np.zeros(50))), x, atol=1e-4)


def test_a_bent_curve_s_mean_and_variance_are_those_of_drawn_codes() -> None:
    rng = np.random.default_rng(5)
    shape = Shape(0.25, 9.0, beta_per_dn=4e-5)
    x = 2000.0
    volts = 0.25 * rng.poisson(x / 0.25, 2_000_000) + 3.0 * rng.standard_normal(2_000_000)
    codes = np.rint(volts * (1 - 4e-5 * volts))
    mean = float(shape.mean(np.array(x), np.zeros(1))[0])
    assert abs(codes.mean() - mean) < 4 * codes.std() / np.sqrt(codes.size)
    variance = float(shape.variance(np.array([mean]))[0])
    assert abs(codes.var() / variance - 1) < 4 * np.sqrt(2 / codes.size)


def test_an_exponential_s_share_is_smooth_at_nothing() -> None:
    t = np.array([-1e-3, -1e-9, 0.0, 1e-9, 1e-3])
    assert np.allclose(exponential_share(t), 1 + t / 2 + t**2 / 6, rtol=1e-9)
