"""What no name explains is carried by a term that is labelled as empirical."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.answer.amended import amended_model
from calib.diagnosis.answer.empirical import best_term, empirical_term
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.shapes.of_effects import departures
from calib.errors import InputError
from calib.forward.effect import Effect
from calib.forward.effects.empirical import Empirical
from calib.forward.model import Model
from calib.radiometric.departures.fitted_chain import carried
from tests.calib.diagnosis.examinations import small_model
from tests.calib.diagnosis.recordings import plan, recorded

SAW = Empirical("temperature", (19.0, 23.0, 27.0, 31.0), (0.0, 1.5, -1.5, 0.0))
"""No effect of the catalogue rises and falls with the temperature."""


def evidence_with(*effects: Effect) -> Evidence:
    rng = default_rng()
    return recorded(small_model(), plan(rng, 120, twice=6), rng, effects)


def test_a_term_of_the_right_variable_leaves_chance_behind() -> None:
    evidence = evidence_with(SAW)
    model = beside(None, evidence)
    term = best_term(model, evidence)
    assert term is not None
    assert term.effect.follows == "temperature"
    x = evidence.table.temperature_c
    added = np.interp(x, term.effect.at, term.effect.add_dn)
    means = np.broadcast_to(added[:, None], model.residual.means.shape)
    left = model.residual.means - evidence.space.project(means)
    freedom = evidence.space.degrees_of_freedom
    before = evidence.space.product(model.residual.means, model.residual.means)
    after = evidence.space.product(left, left)
    assert abs(before - after - term.explained) < 1e-6 * before
    assert before > freedom + 50.0 * np.sqrt(2.0 * freedom)
    # Knots at eight temperatures round the saw's corners off by a part of what they explain.
    assert after - freedom < 5.0 * np.sqrt(2.0 * freedom) + 0.05 * term.explained


def test_the_amended_model_carries_it_and_draws_what_was_recorded() -> None:
    evidence = evidence_with(SAW)
    found = beside(None, evidence)
    assert empirical_term(found, evidence) is not None
    amended = Model.loads(amended_model(found, evidence, small_model().source).dumps())
    assert isinstance(amended.effect("empirical"), Empirical)
    assert [e.name for e in carried(amended.effects)] == ["empirical"]
    rng, blocks = default_rng(), list(evidence.table.blocks)
    spread = []
    for model in (amended.without("empirical"), amended):
        again = recorded(model, blocks, rng)
        old, new = (np.stack([s.mean_dn for s in e.sums]) for e in (evidence, again))
        std = np.sqrt(2.0 * evidence.baseline.variance_dn2 / evidence.n[:, None, None])
        spread.append(float(((new - old) / std).std()))
    assert spread[1] < 1.15 < spread[0]


def test_a_clean_recording_has_none_and_nobody_looks_for_it_by_name() -> None:
    evidence = evidence_with()
    assert best_term(beside(None, evidence), evidence) is None
    assert "empirical" not in {kind.name for kind in departures()}


def test_knots_have_to_ascend_and_to_be_as_many_as_values() -> None:
    for at in ((0.0, 0.0), (0.0, 1.0, 2.0)):
        with pytest.raises(InputError, match="ascending"):
            Empirical("time", at, (1.0, 2.0))
