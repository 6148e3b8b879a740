"""System gain and read noise of recordings whose variances departures have changed."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.departures.shared_noise import DRAWS, shared_noise
from calib.recording.statistics import column_statistics
from tests.calib.radiometric.departures.cases import MODEL, recording

RECORDINGS = 3
CHANGE_VARIANCES = (
    effect_named("interpixel_capacitance")(column_coupling=0.03),
    effect_named("lag")(share=0.03, partition_noise=0.0),
    effect_named("heavy_tailed_noise")(share=0.05, std_e=50.0),
    effect_named("line_noise")(std_dn=1.0),
)


def z_of_noise(found: CoefficientSet) -> tuple[float, float]:
    truth = MODEL.truth()
    gain = found.system_gain_dn_per_e - truth.system_gain_dn_per_e
    read = found.read_noise_e - truth.read_noise_e
    return gain / found.system_gain_dn_per_e_std, read / found.read_noise_e_std


@pytest.mark.parametrize("effect", CHANGE_VARIANCES, ids=lambda e: e.name)
def test_gain_and_read_noise_are_the_sensors(effect: Effect) -> None:
    model, rng = MODEL.with_effect(effect), default_rng()
    z, plain = [], []
    for _ in range(RECORDINGS):
        recorded = recording(model, rng)
        z.append(z_of_noise(calibrate(recorded, model=model).coefficients))
        with np.errstate(all="ignore"):  # curves of photon transfer that bend as no sensor's does
            plain.append(z_of_noise(calibrate(recorded).coefficients))
    # The draws of common random numbers are few, and add a fifth of the recording's own variance.
    bound = 4.0 * np.sqrt(1.2 / RECORDINGS)
    assert (np.abs(np.mean(z, axis=0)) < bound).all()
    assert np.abs(np.mean(plain, axis=0)).max() > bound


def test_noise_that_a_lines_columns_share_leaves_as_much_unsure_as_few_lines_do() -> None:
    recorded = column_statistics(recording(MODEL, default_rng()))
    dark = np.array([s.block.kind == "dark" for s in recorded.fit])
    found = shared_noise(recorded.fit, np.where(dark, 0.5, 0.0), MODEL.camera)
    # Half of the darks' variance, from 5 blocks of 63 degrees of freedom; 1/12 of it is rounding's.
    variance = (MODEL.truth().read_noise_e * MODEL.truth().system_gain_dn_per_e) ** 2
    off = 0.5 * (variance + 1.0 / 12.0) * np.sqrt(2.0 / (5 * 63)) / (2.0 * variance)
    # A standard deviation from DRAWS draws, 4 sigma.
    relative = found.read_noise_e / (off * MODEL.truth().read_noise_e)
    assert abs(relative - 1.0) < 4.0 / np.sqrt(2.0 * (DRAWS - 1))
    none = shared_noise(recorded.fit, np.zeros(len(dark)), MODEL.camera)
    assert (none.system_gain_dn_per_e, none.read_noise_e) == (0.0, 0.0)
