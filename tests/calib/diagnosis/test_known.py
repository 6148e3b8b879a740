from functools import cache

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import Known, beside, known_departures
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.nonlinearity import Nonlinearity
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

BETA_PER_DN = 1e-6


@cache
def bent() -> Evidence:
    rng = default_rng()
    return recorded(plain_model(96), plan(rng, 120, twice=2), rng, (Nonlinearity(BETA_PER_DN),))


def known(beta_per_dn: float) -> Known:
    given = plain_model(96).with_effect(Nonlinearity(beta_per_dn))
    found = known_departures(given, bent(), responder_of(bent()))
    assert found is not None
    return found


def surprise(found: Known | None) -> float:
    """Return by how many standard deviations the means that remain exceed chance."""
    means, freedom = beside(found, bent()).residual.means, bent().space.degrees_of_freedom
    return float(((means**2).sum() - freedom) / np.sqrt(2.0 * freedom))


def test_what_a_given_model_has_is_not_there_to_be_found() -> None:
    assert surprise(None) > 10.0
    found = known(BETA_PER_DN)
    assert abs(surprise(found)) < 5.0
    assert found.names == ("nonlinearity",)
    assert found.off == ()  # four of its standard deviations: once in 16,000 runs


def test_a_given_model_that_has_too_little_of_it_is_told_how_much_there_is() -> None:
    found = known(0.5 * BETA_PER_DN)
    (off,) = found.off
    assert off.name == "nonlinearity.beta_per_dn"
    assert off.model == 0.5 * BETA_PER_DN
    # One linear step from half of it: what bends is a share of a share.
    assert abs(off.fitted - BETA_PER_DN) < 5.0 * np.hypot(off.std, 0.02 * BETA_PER_DN)
    assert abs(surprise(found)) < 5.0


def test_a_model_without_departures_changes_nothing() -> None:
    assert known_departures(plain_model(96), bent(), responder_of(bent())) is None
