"""How often lines are alike by chance: counted where that happens, told where it does not."""

from functools import cache
from math import exp

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.repeated import log_chance, repeated_shapes
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.rare import RARE
from calib.diagnosis.statistics.repeats import UNLIKELY
from calib.forward.effects.duplicated_lines import DuplicatedLines
from tests.calib.diagnosis.recordings import plain_model, plan, recorded


@cache
def evidence(*effects: DuplicatedLines) -> Evidence:
    rng = default_rng()
    return recorded(plain_model(96), plan(rng, 100, twice=0), rng, effects)


def test_pixels_share_a_code_about_as_often_as_is_told() -> None:
    rng, pairs = default_rng(), 400_000
    for sigma in (0.7, 2.0, 10.0):
        one, other = np.rint(rng.normal(rng.uniform(), sigma, (2, pairs)))
        told = 1.0 / (2.0 * sigma * np.sqrt(np.pi))
        alike = float((one == other).mean())
        # Never more than the density's peak; at 0.7 DN its width takes 8 % off.
        assert alike < told + 4.0 * np.sqrt(told / pairs)


def test_what_is_told_is_far_below_what_is_counted() -> None:
    found = evidence()
    for block in range(found.n_blocks):
        assert exp(log_chance(found, block)) <= UNLIKELY * 1.000001


def test_more_repeated_lines_are_more_certain_and_none_are_no_credit() -> None:
    assert repeated_shapes(evidence())[0].freedom == 0.0
    some, many = (repeated_shapes(evidence(DuplicatedLines(p)))[0].cost for p in (0.01, 0.05))
    assert many < some < 0.0


def test_lines_come_twice_as_often_as_they_are_told_to() -> None:
    found, wanted = evidence(DuplicatedLines(0.05)), 0.03
    changed = change_of((DuplicatedLines(wanted),), found, responder_of(found))
    np.testing.assert_allclose(changed.rare[:, RARE.index("identical_lines")], wanted)
