"""Whether radiances scatter about the truth as the stated uncertainty says."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.transmittance import Window
from tests.calib.radiometric.example_set import example_set

N_COLUMNS, EXPOSURE_US = 48, 200.0
GAIN, READ_NOISE_E = 0.1, 20.0
OFFSET_STD, SLOPE_RELATIVE_STD, CORRELATION = 2.0, 0.004, -0.8
TRUTH = example_set(N_COLUMNS, reason=np.zeros(N_COLUMNS, np.uint8))
SLOPE = TRUTH.vignette * 0.2
WINDOW_TRUTH = 0.934


def estimated(
    rng: Generator, *, column: float, scale: float, dark_current: float = 0.0
) -> CoefficientSet:
    """Return a calibration's outcome: the truth with errors as large as it says, or none."""
    common = rng.normal()
    errors = rng.multivariate_normal((0, 0), ((1, CORRELATION), (CORRELATION, 1)), N_COLUMNS)
    offset_std = column * OFFSET_STD
    slope_std = column * SLOPE_RELATIVE_STD * SLOPE
    return example_set(
        N_COLUMNS,
        reason=np.zeros(N_COLUMNS, np.uint8),
        dark_offset_dn=TRUTH.dark_offset_dn + offset_std * errors[:, 0],
        dark_offset_dn_std=np.full(N_COLUMNS, offset_std),
        slope=(SLOPE + slope_std * errors[:, 1]) * (1 + scale * common),
        slope_std=slope_std,
        offset_slope_covariance=CORRELATION * offset_std * slope_std,
        scale_relative_std=scale,
        dark_current_dn_per_us=np.full(N_COLUMNS, dark_current),
        system_gain_dn_per_e=GAIN,
        read_noise_e=READ_NOISE_E,
    )


def drawn(
    rng: Generator, radiance: float, n_lines: int, *, dark_current: float = 0.0
) -> np.ndarray:
    """Return codes of a uniform scene, (n_lines, N_COLUMNS)."""
    per_us = radiance * SLOPE + dark_current
    electrons = rng.poisson(per_us * EXPOSURE_US / GAIN, (n_lines, N_COLUMNS))
    volts = GAIN * (electrons + rng.normal(0, READ_NOISE_E, electrons.shape))
    return np.rint(volts + TRUTH.dark_offset_dn).astype(np.uint16)


def assert_spread_is_one(z: np.ndarray) -> None:
    """`z` is (n_draws, n_samples); samples of one draw share errors, so that draws are judged."""
    for per_draw, expected in (((z**2).mean(axis=1), 1.0), (z.mean(axis=1), 0.0)):
        standard_error = per_draw.std(ddof=1) / np.sqrt(len(per_draw))
        assert standard_error < 0.09
        assert abs(per_draw.mean() - expected) < 4 * standard_error


@pytest.mark.parametrize("radiance", [2.0, 30.0, 90.0])
@pytest.mark.parametrize(
    ("column", "scale"), [(0.0, 0.0), (1.0, 0.0), (0.0, 0.02), (1.0, 0.01)],
    ids=["temporal noise", "columns", "scale", "all"],
)  # fmt: skip
def test_single_samples_scatter_as_stated(radiance, column, scale):
    z = []
    for rng in default_rng([int(radiance), int(column), int(1000 * scale)]).spawn(400):
        correction = Correction(
            estimated(rng, column=column, scale=scale), EXPOSURE_US, camera=TRUTH.camera
        )
        result = correction.lines(drawn(rng, radiance, 2))
        z.append(((result.radiance - radiance) / result.std).ravel())
    assert_spread_is_one(np.array(z, np.float64))


@pytest.mark.parametrize("radiance", [0.0, 2.0, 30.0])
@pytest.mark.parametrize("n_lines", [1, 100])
def test_the_shot_noise_of_a_dark_current_is_in_the_uncertainty(radiance, n_lines):
    """100 DN of dark signal: 10 DN² of shot noise beside the 4 DN² of read noise."""
    z = []
    for rng in default_rng([int(radiance), n_lines]).spawn(400):
        coefficients = estimated(rng, column=0.0, scale=0.0, dark_current=0.5)
        correction = Correction(coefficients, EXPOSURE_US, camera=TRUTH.camera)
        dn = drawn(rng, radiance, n_lines, dark_current=0.5)
        result = correction.lines(dn) if n_lines == 1 else correction.mean_line(dn)
        z.append(((result.radiance - radiance) / result.std).ravel())
    assert_spread_is_one(np.array(z, np.float64))


@pytest.mark.parametrize("n_lines", [1, 100])
def test_the_mean_of_lines_scatters_as_stated(n_lines):
    z = []
    for rng in default_rng(81 + n_lines).spawn(400):
        correction = Correction(
            estimated(rng, column=1.0, scale=0.001), EXPOSURE_US, camera=TRUTH.camera
        )
        mean = correction.mean_line(drawn(rng, 30.0, n_lines))
        z.append(((mean.radiance - 30.0) / mean.std).ravel())
    assert_spread_is_one(np.array(z, np.float64))


def test_radiance_behind_a_window_scatters_as_stated():
    z = []
    for rng in default_rng(17).spawn(400):
        window = Window(WINDOW_TRUTH * (1 + 0.01 * rng.normal()), 0.01 * WINDOW_TRUTH)
        correction = Correction(
            estimated(rng, column=0.0, scale=0.0), EXPOSURE_US, camera=TRUTH.camera, window=window
        )
        result = correction.lines(drawn(rng, 30.0 * WINDOW_TRUTH, 2))
        z.append(((result.radiance - 30.0) / result.std).ravel())
    assert_spread_is_one(np.array(z, np.float64))
