from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.random import default_rng

from calib.arrays import Columns
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.laws import laws
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.search import FALSE_ALARMS, THRESHOLD, find
from calib.diagnosis.shapes.of_effects import departures, shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.gain_drift import GainDrift
from calib.forward.effects.lag import Lag
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.offset_drift import OffsetDrift
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS = 128
NAMES = ("offset_drift", "gain_drift", "nonlinearity", "lag", "amplifier_glow", "stray_light")


def recording(*effects: Effect) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(COLUMNS), plan(rng, 80), rng, effects)


@cache
def clean() -> Evidence:
    return recording()


def contest_of(evidence: Evidence, names: Sequence[str] = NAMES) -> Contest:
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in names for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    return Contest(tuple(each for each in found if each is not None), evidence, responder)


def found_in(evidence: Evidence) -> list[str]:
    model = find(contest_of(evidence), beside(None, evidence))
    return [member.effect.name for member in model.members]


def found_of(
    course: Columns, pattern: Columns, sigma: float, names: Sequence[str] = NAMES
) -> Model:
    """Return what is found in a clean recording to whose means course times pattern was added."""
    nothing = beside(None, clean())
    added = replace(nothing.observed * 0.0, means=np.outer(course, pattern))
    point = clean().point(added)
    observed = nothing.observed + added * (sigma / np.sqrt(clean().product(point, point)))
    residual = clean().point(observed)
    started = replace(nothing, observed=observed, residual=residual, first=residual)
    return find(contest_of(clean(), names), started)


def test_a_name_is_fitted_once_in_a_place_whatever_laws_are_free_elsewhere() -> None:
    evidence = recording(Nonlinearity(2e-6))
    contest, nothing = contest_of(evidence, ("nonlinearity",)), beside(None, evidence)
    opened = replace(contest, free=frozenset({"time"}))
    (one,), (other,) = contest.ranking(nothing), opened.ranking(nothing)
    first = contest.placed(nothing, None, one)
    assert opened.placed(nothing, None, other) is first
    # Another strength to begin with, and another model of the same contents, are others.
    assert contest.placed(nothing, None, replace(one, amplitude=2.0 * one.amplitude)) is not first
    assert contest.placed(replace(nothing), None, one) is not first


def test_two_effects_are_both_named_and_nothing_else() -> None:
    assert sorted(found_in(recording(Nonlinearity(2e-6), Lag(0.01)))) == ["lag", "nonlinearity"]


def test_a_drift_is_named_after_what_drifts() -> None:
    assert found_in(recording(OffsetDrift(2.0, 10.0))) == ["offset_drift"]
    assert found_in(recording(GainDrift(0.02, 10.0))) == ["gain_drift"]


def test_an_offset_that_comes_and_goes_is_an_offset_drift_of_a_free_course() -> None:
    time = clean().table.mid_s / clean().table.mid_s.max()
    model = found_of(np.sin(2.0 * np.pi * time) ** 2, np.ones(COLUMNS), 50.0)
    assert [member.effect.name for member in model.members] == ["offset_drift"]
    assert model.members[0].course


def test_lamps_that_lose_only_where_all_of_them_burn_are_not_additive() -> None:
    level = clean().table.level
    course = clean().signal_dn * (level == level.max())
    names = (*NAMES, "level_nonadditivity")
    model = found_of(course, np.ones(COLUMNS), 50.0, names)
    assert [member.effect.name for member in model.members] == ["level_nonadditivity"]


def test_what_no_name_of_the_catalogue_does_gets_none() -> None:
    signal, time = clean().signal_dn, clean().table.mid_s
    tilt = np.linspace(-1.0, 1.0, COLUMNS)
    # A source that turns before the lens.
    assert found_of(signal * (time - time.mean()), tilt, 60.0).members == ()


def test_of_profiles_and_noise_brighter_fatter_may_take_different_shares_and_capacitance_not() -> (
    None
):
    names = ("brighter_fatter", "interpixel_capacitance")
    found = {s.shape.name: s for s in contest_of(clean(), names).signatures}
    brighter, coupled = (found[name] for name in names)
    *_, own = laws(brighter, clean()).parts
    np.testing.assert_array_equal(own.means, brighter.change.means)
    assert clean().product(clean().point(own), clean().point(own)) > 0.0
    assert not np.any(own.pooled)
    assert not any(
        np.array_equal(part.means, coupled.change.means) for part in laws(coupled, clean()).parts
    )


def test_chance_passes_the_threshold_about_as_often_as_is_said() -> None:
    contest = contest_of(clean())
    taken, draws = contest.signatures, 100_000
    gram = np.array([[clean().product(a.point, b.point) for b in taken] for a in taken])
    length = np.sqrt(np.diag(gram))
    values, vectors = np.linalg.eigh(gram / np.outer(length, length))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    amplitude = default_rng().standard_normal((draws, len(taken))) @ root.T
    signed = np.array([each.shape.two_sided for each in taken])
    gain = np.where(signed, amplitude, np.maximum(amplitude, 0.0)) ** 2
    price = np.array([contest.price_of_shape(each.shape) for each in taken])
    alarms = ((gain - price).max(axis=1) > THRESHOLD).sum()
    # Of the catalogue's names some are tried here.
    said = FALSE_ALARMS * draws * len(NAMES) / len(departures())
    # Shapes that are alike, and strengths of one sign, make them rarer.
    assert 0.1 * said < alarms < said + 5.0 * np.sqrt(said)
