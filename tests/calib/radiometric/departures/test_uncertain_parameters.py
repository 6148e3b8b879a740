"""What the uncertainty of a departure's parameter does to a set."""

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.stats import chi2

from calib.errors import InputError
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.radiometric.coefficients.coefficient_set import CoefficientSet
from tests.calib.radiometric.departures.cases import MODEL, recording

RECORDINGS = 3
TRUE, STD = 1e-5, 2e-6
CHANCE = 1e-5


def z_of_slope(found: CoefficientSet) -> float:
    """Of the columns' mean: the parameter's error moves all of them together."""
    truth = MODEL.truth()
    off = found.slope / (truth.vignette * truth.responsivity) - 1.0
    std = np.hypot(found.slope_std / found.slope, found.scale_relative_std)
    return float(off.mean() / std.mean())


def stated(beta: float, std: float) -> Model:
    model = MODEL.with_effect(Nonlinearity(beta))
    return Model(model.camera, model.source, model.effects, {"nonlinearity": {"beta_per_dn": std}})


def test_the_sets_uncertainty_holds_that_of_the_parameter() -> None:
    rng = default_rng()
    z = []
    for _ in range(RECORDINGS):
        recorded = recording(MODEL.with_effect(Nonlinearity(TRUE)), rng)
        beta = TRUE + STD * rng.standard_normal()
        z.append(z_of_slope(calibrate(recorded, model=stated(beta, STD)).coefficients))
    low, high = chi2.ppf([CHANCE, 1.0 - CHANCE], RECORDINGS)
    # Columns' own errors are in the std, too, and average out: z is a little small.
    assert 0.5 * low < np.sum(np.square(z)) < high


def test_the_budget_tells_it_and_without_it_nothing_changes() -> None:
    rng = default_rng()
    recorded = recording(MODEL.with_effect(Nonlinearity(TRUE)), rng)
    certain = calibrate(recorded, model=stated(TRUE, 0.0)).coefficients
    known = calibrate(recorded, model=MODEL.with_effect(Nonlinearity(TRUE))).coefficients
    wide = calibrate(recorded, model=stated(TRUE, STD)).coefficients
    np.testing.assert_array_equal(certain.slope_std, known.slope_std)
    assert certain.budget == known.budget
    row = wide.budget.rows[-1]
    assert (row.quantity, row.kind, row.value) == ("nonlinearity beta_per_dn", "B", STD)
    assert (wide.slope_std > certain.slope_std).all()
    added = np.sqrt(wide.responsivity_std**2 - known.responsivity_std**2) / wide.responsivity
    np.testing.assert_allclose(np.median(added), row.contribution, rtol=1e-6)
    np.testing.assert_array_equal(wide.slope, known.slope)


@pytest.mark.parametrize("std", [-1.0, float("nan"), float("inf"), True, "small"])
def test_a_model_refuses_what_is_no_uncertainty(std: object) -> None:
    with pytest.raises(InputError, match="give a number") as refusal:
        stated(TRUE, std)  # type: ignore[arg-type]
    assert refusal.value.code == "bad-uncertainty"


def test_a_model_file_keeps_uncertainties() -> None:
    model = stated(TRUE, STD)
    assert Model.loads(model.dumps()) == model
    assert model.without("nonlinearity").uncertainty == {}
    assert "uncertainty" not in MODEL.dumps()
