"""Rates of dark current that the recording tells pixel by pixel, and what they cost."""

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.judgement import candidates_of
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.dark_rates import (
    BY_CHANCE,
    MOST_OF_ONE,
    dark_rate_shapes,
    growth_dn,
)
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.departure import Departure
from calib.forward.effects.amplifier_glow import AmplifierGlow
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.dark_current_temperature import DarkCurrentTemperature
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.offset_drift import OffsetDrift
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS = 128
MEAN = 0.02
KINDS = (DarkCurrent, DarkCurrentTemperature)
TRIED = (*KINDS, AmplifierGlow, OffsetDrift)


def evidence_with(*effects: Departure) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(COLUMNS), plan(rng, 60), rng, effects)


def found_in(evidence: Evidence) -> tuple[Model, Contest]:
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [
        s for kind in TRIED for s in (*shapes_of(kind, scales), *dark_rate_shapes(kind, evidence))
    ]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    return find(contest, beside(None, evidence)), contest


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_rates_that_are_exponential_among_pixels_are_dark_current(kind: type[Departure]) -> None:
    # Half of the pixels have less than ln 2 of the mean, one in a hundred five times as much.
    rates = tuple(default_rng().exponential(MEAN, COLUMNS).tolist())
    warm = {"doubling_k": 6.0} if kind is DarkCurrentTemperature else {}
    evidence = evidence_with(kind(electrons_per_us=0.0, rates_e_per_us=rates, **warm))
    model, contest = found_in(evidence)
    (member,) = model.members
    assert isinstance(member.effect, kind)
    seen = np.asarray(getattr(member.effect, "rates_e_per_us"))  # noqa: B009 - of either kind
    exposure = evidence.table.exposure_us
    if isinstance(member.effect, DarkCurrentTemperature):
        assert member.effect.doubling_k == 6.0
        exposure = exposure * 2.0 ** ((evidence.table.temperature_c - 25.0) / 6.0)
    _, std = growth_dn(exposure, evidence)
    z = (seen - rates) * evidence.baseline.gain_dn_per_e[0] * exposure.max() / std
    assert np.abs(z).max() < 6.0  # of 128 normal numbers, and a gain that is fitted
    assert candidates_of(0, model, contest)[0].effect == kind.name


@pytest.mark.parametrize(
    "effects",
    [(), (HotPixels(0.05, 0.5),), (AmplifierGlow(0.2, 20.0),)],
    ids=["nothing", "hot pixels", "glow"],
)
def test_neighbours_that_do_not_differ_have_no_rates_of_their_own(
    effects: tuple[Departure, ...],
) -> None:
    evidence = evidence_with(*effects)
    assert not any(dark_rate_shapes(kind, evidence) for kind in KINDS)


def test_what_chance_makes_of_a_difference_is_cut() -> None:
    z = default_rng().standard_normal(100_000)
    cut = np.minimum(z**2, MOST_OF_ONE)
    assert abs(cut.mean() - BY_CHANCE) < 5.0 * cut.std() / np.sqrt(cut.size)
