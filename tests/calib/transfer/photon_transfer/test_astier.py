import numpy as np
import pytest

from calib.transfer.photon_transfer.charge_covariance import Form, covariance_model
from calib.transfer.photon_transfer.measure import photon_transfer
from calib.transfer.photon_transfer.variance_curve import Shape
from tests.calib.transfer.photon_transfer.simulated import A_PER_E, GAIN, recording


def test_a_pixel_alone_has_the_exponential_s_first_terms() -> None:
    # With a00 alone Eq. 20 is Eq. 16 expanded: the next term is (2aN)⁴/120 of N.
    a00, electrons = -1e-6, np.array([1e3, 1e4, 5e4])
    a = np.array([[a00]])
    series = covariance_model(electrons, 1.0, a, 0 * a, Form.FULL)[0, 0]
    closed = Shape(1.0, 0.0, a00_per_e=a00).charge_variance(electrons)
    left = electrons * (2 * a00 * electrons) ** 4 / 120
    assert np.allclose(series - closed, -left, rtol=0.05)


def test_convolutions_reach_over_both_sides() -> None:
    # (a∗a)_00 = a00² + 2·a01², (a∗a)_01 = 2·a00·a01, (a∗a)_02 = a01² are written out here.
    a = np.array([[-3e-6, 1e-6, 0.0]])
    n, ab = np.array([2e4]), np.array([[1e-12, 0.0, 0.0]])
    found = covariance_model(n, 1.0, a, ab, Form.FULL)[0, :, 0]
    two = np.array([9e-12 + 2e-12, -6e-12, 1e-12])
    # a∗a∗a at lags 0, 1, 2, with two = a∗a also at the lag 3 that is 0.
    three = np.array(
        [
            a[0, 0] * two[0] + 2 * a[0, 1] * two[1],
            a[0, 0] * two[1] + a[0, 1] * (two[0] + two[2]),
            a[0, 0] * two[2] + a[0, 1] * two[1],
        ]
    )
    mixed = a[0] * 1e-12
    unit = np.array([1.0, 0.0, 0.0])
    wanted = 2e4 * (
        unit + a[0] * 2e4 + 2 / 3 * (two + ab[0]) * 4e8 + (2 * three + 5 * mixed) / 6 * 8e12
    )
    assert np.allclose(found, wanted, rtol=1e-12)


def test_a_area_sensor_s_convolution_reaches_over_four_sides() -> None:
    a = np.array([[0.0, 1e-6], [1e-6, 0.0]])
    n = np.array([1e4])
    found = covariance_model(n, 1.0, a, 0 * a, Form.FULL)[0, 0, 0]
    assert found == pytest.approx(1e4 * (1 + 2 / 3 * 4e-12 * 1e8), rel=1e-12)


@pytest.mark.parametrize("seed", range(2))
def test_charge_that_repels_is_found_with_its_range(seed: int) -> None:
    drawn = recording("brighter_fatter", 400, 600, np.random.default_rng(seed))
    tap = photon_transfer(drawn).taps[0]
    assert tap.choice.called_for.label == "brighter_fatter"
    full = tap.astier[Form.FULL]
    # Charge was drawn in 16 steps, each of which sees only the ones before: 15/16 of a.
    z = (full.a_per_e[0] - 15 / 16 * A_PER_E) / full.a_std[0]
    assert (np.abs(z) < 4).all()
    assert (np.abs(full.a_per_e[0]) > np.array([5, 5, 2]) * full.a_std[0]).all()
    assert abs(full.system_gain - GAIN) < 4 * full.system_gain_std
    left = full.chi_squared - full.freedom
    assert abs(left) < 5 * np.sqrt(2 * full.freedom)
    first = tap.astier[Form.FIRST_ORDER]
    assert abs(first.a_per_e[0, 0]) < abs(full.a_per_e[0, 0])
