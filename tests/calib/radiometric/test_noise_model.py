import numpy as np
import pytest

from calib.errors import NotDeterminedError
from calib.radiometric.estimation.noise_model import NoiseModel, fit_noise_model

CASES = [
    pytest.param(12, 0.15, 1.5, id="12-bit"),
    pytest.param(8, 0.004, 0.35, id="8-bit"),
    pytest.param(8, 0.0035, 0.17, id="8-bit-below-rounding"),
    pytest.param(12, 0.1, 0.0, id="no-read-noise"),
]


@pytest.mark.parametrize(("bits", "gain", "read"), CASES)
def test_system_gain_and_read_noise_come_back(bits: int, gain: float, read: float) -> None:
    rng = np.random.default_rng()
    n, lines = 300, 200
    offset = 5.0 + 2.0 * rng.random(n)
    signals = np.linspace(0.1, 0.7, 6)[:, None] * 2**bits * (0.8 + 0.4 * rng.random(n))
    electrons = rng.poisson(signals / gain, (lines, *signals.shape))
    dn = np.rint(gain * electrons + read * rng.standard_normal(electrons.shape) + offset)
    model = fit_noise_model(
        dn.mean(axis=0),
        dn.var(axis=0, ddof=1),
        np.full(6, lines),
        offset,
        np.ones(signals.shape, np.bool_),
    )
    assert abs(model.system_gain_dn_per_e - gain) < 5 * model.system_gain_dn_per_e_std
    assert abs(model.read_variance_dn2 - read**2) < 5 * model.read_variance_dn2_std
    assert model.system_gain_dn_per_e_std < 0.05 * gain


def test_single_lines_do_not_tell_the_noise() -> None:
    cells = np.full((3, 4), 10.0)
    with pytest.raises(NotDeterminedError) as refusal:
        fit_noise_model(cells, cells * np.nan, np.ones(3), np.zeros(4), np.ones((3, 4), np.bool_))
    assert refusal.value.code == "no-temporal-noise"


def test_noise_grows_with_the_root_of_the_signal() -> None:
    model = NoiseModel(0.5, 4.0, 0.0, 0.0)
    np.testing.assert_allclose(model.sigma_dn(np.array([-5.0, 0.0, 10.0])), [2.0, 2.0, 3.0])
    assert model.read_noise_e == 4.0


def test_read_noise_in_electrons_is_unknown_without_shot_noise() -> None:
    assert np.isnan(NoiseModel(0.0, 4.0, 0.1, 0.1).read_noise_e)


def test_read_noise_in_electrons_scatters_as_stated() -> None:
    """Of a line that turns about its middle, gain and read noise err with opposite signs."""
    rng, lines, n = np.random.default_rng(), 100.0, 400
    signal = np.linspace(5.0, 60.0, 6)[:, None] * np.ones(300)
    truth, z = 0.15 * signal + 1.5**2 + 1.0 / 12.0, []
    for _ in range(n):
        variance = truth * rng.chisquare(lines - 1.0, signal.shape) / (lines - 1.0)
        model = fit_noise_model(
            signal + 50.0,
            variance,
            np.full(6, lines),
            np.full(300, 50.0),
            np.ones(signal.shape, np.bool_),
        )
        z.append((model.read_noise_e - 1.5 / 0.15) / model.read_noise_e_std)
    assert abs(np.mean(z)) < 4 / np.sqrt(n)
    assert abs(np.std(z) - 1) < 4 / np.sqrt(2 * n)
