"""A landscape swept across the line, as in AgCam's Figs. 8 and 9: known radiance, corrected."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.random import default_rng

from calib.forward.conditions import Conditions
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.correction.apply import Correction
from calib.radiometric.correction.flags import Flag
from calib.radiometric.correction.radiance_lines import Radiance
from calib.radiometric.correction.transmittance import Window
from calib.radiometric.estimation.source_uncertainty import SourceUncertainty
from calib.radiometric.landscape import Landscape
from tests.calib.radiometric.in_memory import agcam_plan, record

EXACT_SOURCE = SourceUncertainty(0.0, 0.0, 0.0)
N_LINES, SKY_LINES = 120, 15


@dataclass(frozen=True)
class Sweep:
    truth: np.ndarray
    dn: np.ndarray
    correction: Correction
    corrected: Radiance

    @property
    def usable(self) -> np.ndarray:
        bad = Flag.SATURATED | Flag.BELOW_BLACK | Flag.MASKED
        return (self.corrected.flags & bad) == 0


CASES = {
    "NIR, 300 us": ("agcam-nir", 300.0, Landscape(sky=14.0, field=15.0, woods=9.0), None),
    "red, 200 us": ("agcam-red", 200.0, Landscape(sky=5.0, field=2.6, woods=1.5), None),
    "NIR, window": ("agcam-nir", 200.0, Landscape(sky=25.0, field=22.0, woods=9.0), 0.934),
}


@pytest.fixture(scope="module", params=CASES.values(), ids=CASES)
def sweep(request) -> Sweep:
    preset, exposure_us, landscape, transmittance = request.param
    model = Model.preset(preset)
    rng = default_rng(int(exposure_us))
    recording = record(model, agcam_plan(100), rng, 100)
    coefficients = calibrate(recording, source=EXACT_SOURCE).coefficients
    truth = landscape.image(N_LINES, model.camera.columns, rng)
    at = Conditions.steady(N_LINES, exposure_us=exposure_us, line_period_us=1400.0)
    dn = model.draw(at, rng, truth * (transmittance or 1.0)).dn
    window = None if transmittance is None else Window(transmittance, 0.0)
    correction = Correction(coefficients, exposure_us, camera=model.camera, window=window)
    return Sweep(truth, dn, correction, correction.lines(dn))


def test_radiance_agrees_with_the_truth_within_its_stated_uncertainty(sweep):
    with np.errstate(invalid="ignore"):
        z = (sweep.corrected.radiance - sweep.truth) / sweep.corrected.std
    z = np.where(sweep.usable, z, np.nan)[:, sweep.correction.coefficients.valid]
    for per_column, expected in ((np.nanmean(z**2, axis=0), 1.0), (np.nanmean(z, axis=0), 0.0)):
        standard_error = per_column.std(ddof=1) / np.sqrt(len(per_column))
        assert standard_error < 0.004
        assert abs(per_column.mean() - expected) < 4 * standard_error


def _cov(lines: np.ndarray) -> np.ndarray:
    """Coefficient of variation of each line along the columns."""
    return lines.std(axis=1, ddof=1) / lines.mean(axis=1)


def test_a_line_of_sky_becomes_as_uniform_as_its_noise_allows(sweep):
    good = sweep.correction.coefficients.valid
    vignette = sweep.correction.coefficients.vignette
    before = _cov((sweep.dn[:SKY_LINES] / vignette)[:, good])
    radiance = sweep.corrected.radiance[:SKY_LINES, good].astype(np.float64)
    after = _cov(radiance)
    stated = np.sqrt((sweep.corrected.std[:SKY_LINES, good] ** 2).mean(axis=1))
    ratio = after / (stated / radiance.mean(axis=1))
    standard_error = 1 / np.sqrt(2 * good.sum() * SKY_LINES)
    assert abs(ratio.mean() - 1) < 4 * standard_error
    assert after.max() < 0.35 * before.min()


def test_the_mean_of_the_sky_lines_is_uniform_within_its_uncertainty(sweep):
    good = sweep.correction.coefficients.valid
    mean = sweep.correction.mean_line(sweep.dn[:SKY_LINES])
    z = ((mean.radiance - sweep.truth[0]) / mean.std)[0, good]
    # neighbours share the errors of a fit of the vignette at most slightly: QE = slope / VE
    assert abs(np.mean(z.astype(np.float64) ** 2) - 1) < 4 * np.sqrt(2 / good.sum()) + 0.02


def test_the_landscape_is_recovered_not_only_the_sky(sweep):
    ground = sweep.usable & (sweep.truth != sweep.truth.max()) & np.isfinite(sweep.corrected.std)
    ground[: SKY_LINES + 10] = False
    error = (sweep.corrected.radiance - sweep.truth)[ground].astype(np.float64)
    spread = sweep.truth[ground].std()
    noise = np.sqrt((sweep.corrected.std[ground].astype(np.float64) ** 2).mean())
    assert np.corrcoef(sweep.corrected.radiance[ground], sweep.truth[ground])[0, 1] > 0.95
    assert abs(error.std() / noise - 1) < 0.02
    assert spread > 2 * noise
