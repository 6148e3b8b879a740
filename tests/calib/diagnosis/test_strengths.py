"""Strengths of effects that are seen at hundreds of standard deviations: bias and scatter."""

import numpy as np
import pytest

from tests.calib.diagnosis.coverage import errors_of

STRONG: dict[str, dict[str, object]] = {
    "lag": {"share": 0.01},
    "interpixel_capacitance": {"column_coupling": 0.05},
    "cti": {"per_transfer": 3e-4, "partition_noise": 0.0},
    "nonlinearity": {"beta_per_dn": 1e-5},
    "exposure_jitter": {"relative_std": 0.003},
    "line_noise": {"std_dn": 0.5},
    "banding": {"amplitude_dn": 0.5},
    "lamp_flicker": {"amplitude": 0.004},
}
SHORT = 6


def hold(name: str, runs: int) -> None:
    every = [errors_of(name, STRONG[name]) for _ in range(runs)]
    key = next(iter(STRONG[name]))
    error, std = np.array([each[key] for each in every]).T
    z = error / std
    # 4.5 standard errors of a mean, and of a standard deviation, each: once in 100,000 runs. One
    # recording of some hundred is farther off than 4: it counts as 3.
    held = np.clip(z, -3.0, 3.0)
    assert abs(held.mean()) < 4.5 / np.sqrt(runs)
    assert (held**2).mean() < 1.0 + 4.5 * np.sqrt(2.0 / runs)


@pytest.mark.parametrize("name", ["lag", "nonlinearity", "banding"])
def test_a_strong_effect_is_measured_without_bias(name: str) -> None:
    hold(name, SHORT)


@pytest.mark.soak
@pytest.mark.parametrize("name", STRONG)
def test_strong_effects_are_measured_without_bias_and_scatter_as_stated(name: str) -> None:
    hold(name, 40)
