"""How sure a name may be where others are strong, and physics has no name."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.naming.imperfection import ASTRAY, IMPERFECT, energies, left_by_others
from calib.diagnosis.naming.judgement import HELD, Explained, told
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA
from calib.diagnosis.naming.unnamed import BEFORE, odds_of_none
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.nonlinearity import Nonlinearity
from tests.calib.diagnosis.examinations import examined

EFFECTS = (Nonlinearity(6e-6), InterpixelCapacitance(0.02))


def test_probabilities_are_kept_where_physics_may_have_no_name() -> None:
    rng, n = default_rng(), 200_000
    gain = np.exp(rng.uniform(np.log(16.0), np.log(10_000.0), n))
    excused = rng.choice([0.0, 30.0], n)
    named = rng.random(n) < 1.0 / (1.0 + BEFORE)
    # At random in two directions: sin^2 of the angle is uniform; what is left has to go unseen.
    angle2 = rng.random(n)
    unseen = gain * angle2 / (1.0 - angle2) < CERTAIN_SIGMA**2 + excused
    found = named | unseen
    stated = np.array(
        [1.0 / (1.0 + odds_of_none(g, e)) for g, e in zip(gain, excused, strict=True)]
    )
    for low in np.arange(0.5, 1.0, 0.1):
        inside = found & (stated >= low) & (stated < low + 0.1)
        p = stated[inside].mean()
        assert abs(named[inside].mean() - p) < 5.0 * np.sqrt(p * (1.0 - p) / inside.sum())


def test_names_together_are_as_likely_as_that_there_is_one() -> None:
    names = {name: Explained(deviance, 0.0) for name, deviance in (("a", 40.0), ("b", 39.0))}
    sure, unsure = told(names, 1.0), told(names, 1.0, none=0.25)
    assert [c.effect for c in sure] == [c.effect for c in unsure] == ["a", "b"]
    assert HELD < sum(c.probability for c in sure) <= 1.0
    for one, other in zip(sure, unsure, strict=True):
        np.testing.assert_allclose(other.probability, one.probability / 1.25, rtol=1e-12)


def test_errors_of_a_strong_effect_widen_what_lives_where_it_does() -> None:
    seen = examined(EFFECTS)
    names = [m.signature.shape.name for m in seen.model.members]
    assert sorted(names) == sorted(e.name for e in EFFECTS)
    bend, capacitance = (names.index(e.name) for e in EFFECTS)
    moved = seen.evidence.point(seen.model.members[bend].changes[0])
    moved = moved * seen.model.members[bend].strength
    strong = float(energies(moved, seen.evidence).sum())
    left = left_by_others(capacitance, seen.model, seen.evidence)
    # Means and covariances have next to nothing in common: errors go astray there, and no more.
    assert ASTRAY * IMPERFECT * strong < 1.2 * left < 1.2 * (ASTRAY + 0.2) * IMPERFECT * strong
    (finding,) = (f for f in seen.diagnosis.findings if f.effect.name == EFFECTS[1].name)
    member = seen.model.members[capacitance]
    units = {name: unit for name, unit, _ in member.signature.shape.varied}
    slope = units["column_coupling"]
    assert isinstance(slope, float)
    ratio = finding.parameters["column_coupling"].std / (member.std[0] * abs(slope))
    np.testing.assert_allclose(ratio, np.sqrt(1.0 + left), rtol=1e-12)
    alone = replace(seen.model, members=(member,))
    assert left_by_others(0, alone, seen.evidence) == 0.0
