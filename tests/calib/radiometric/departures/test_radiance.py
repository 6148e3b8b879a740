"""Radiance of a scene by a set that carries its departures, against the truth."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from calib.radiometric.correction.apply_options import ApplyOptions
from calib.radiometric.correction.blocks_to_correct import corrections_by_block
from tests.calib.radiometric.departures.cases import (
    CASES,
    COLUMNS,
    PATTERN_LINES,
    Case,
    radiance_error,
    recording,
    scene_radiance,
    scenes,
)
from tests.calib.radiometric.departures.fitting import Fit
from tests.calib.radiometric.in_memory import InMemory

SCENE_LINES = 512
SIGMA = 5.0
MEAN_SQUARE_STD = np.sqrt(2.0 / COLUMNS)
"""Of z over one scene: phases of a column share its coefficients' error."""


NOISE_OFF = 0.05
"""How far the samples' own noise may be off: 4 of the gain's standard uncertainties, 1.2 % here."""


def z_and_scatter(found: CoefficientSet, seen: InMemory) -> tuple[np.ndarray, np.ndarray]:
    """Errors of mean radiance by phase of the pattern and column, over what the set says of them.

    Standard uncertainties are those of the samples, with their temporal part averaged. Also the
    samples' variance over that part, by scene.
    """
    z, scatter = [], []
    every = corrections_by_block(seen, found, ApplyOptions(), seen.header.blocks)
    for name, correction in every.items():
        lines = correction.lines(np.concatenate([*seen.frames(name)]))
        radiance, std = (
            each.astype(np.float64).reshape(-1, PATTERN_LINES, COLUMNS)[1:]
            for each in (lines.radiance, lines.std)
        )
        scale = correction.terms.scale
        shared = correction.terms.coefficient_variance_dn2(radiance / scale) * scale**2
        temporal = np.mean(std**2 - shared, axis=0)
        scatter.append(np.mean(radiance.var(axis=0, ddof=1) / temporal))
        variance = temporal / len(radiance) + shared.mean(axis=0)
        z.append((radiance.mean(axis=0) - scene_radiance(PATTERN_LINES)) / np.sqrt(variance))
    return np.array(z), np.array(scatter)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_radiance_is_right_within_its_uncertainty(case: Case) -> None:
    rng = default_rng()
    recorded, seen = recording(case.model, rng), scenes(case.model, rng, SCENE_LINES)
    found = calibrate(recorded, model=case.model).coefficients
    assert found.valid.all()
    z, scatter = z_and_scatter(found, seen)
    assert (np.abs(np.mean(z**2, axis=(1, 2)) - 1.0) < SIGMA * MEAN_SQUARE_STD).all()
    freedom = z[0].size * (SCENE_LINES / PATTERN_LINES - 2)
    assert (np.abs(scatter - 1.0) < NOISE_OFF + SIGMA * np.sqrt(2.0 / freedom)).all()
    if case.fitted:  # what a plain estimation does not take off by itself
        plain = radiance_error(calibrate(recorded).coefficients, seen)
        assert plain > 1.2 * radiance_error(found, seen)


def check_fitted(name: str) -> None:
    case, rng = next(c for c in CASES if c.name == name), default_rng()
    recorded, seen = recording(case.model, rng), scenes(case.model, rng, SCENE_LINES)
    true, fitted = (
        radiance_error(calibrate(recorded, model=m).coefficients, seen)
        for m in (case.model, Fit(case, recorded).model())
    )
    assert fitted < 1.2 * true


@pytest.mark.parametrize("name", ["nonlinearity", "exposure_offset"])
def test_fitted_parameters_do_as_well_as_the_true_ones(name: str) -> None:
    check_fitted(name)


@pytest.mark.soak
@pytest.mark.parametrize("name", [c.name for c in CASES if c.fitted and not c.by_covariance])
def test_fitted_parameters_do_as_well_as_the_true_ones_for_every_departure(name: str) -> None:
    check_fitted(name)
