"""Effects of neighbours whose law is left free: one name, and its strengths those of the noise."""

import numpy as np
from numpy.random import Generator, default_rng

from calib.arrays import Lines
from calib.diagnosis.diagnose import responder_of, scales_of
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.search import find
from calib.diagnosis.naming.shapes import shapes_of
from calib.diagnosis.naming.signatures import signature
from calib.forward.conditions import Conditions
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.catalogue import effect_named
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

NAMES = ("brighter_fatter", "interpixel_capacitance", "nonlinearity")
PER_E = 4e-6


class OwnFlux(BrighterFatter):
    """Pixels send away what comes to themselves: profiles lose twice as much for the same noise."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        moved = super().apply(signal, at, rng)
        return moved + (moved - signal).mean(axis=0)


def test_charge_repelled_alike_along_rows_and_columns_is_brighter_fatter_alone() -> None:
    model = plain_model(48, rows=12)
    rng = default_rng()
    effect = OwnFlux(row_per_e=PER_E, column_per_e=PER_E, corner_per_e=0.0)
    evidence = recorded(model, plan(rng, 60), rng, (effect,))
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in NAMES for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    (member,) = find(contest, beside(None, evidence)).members
    told = member.effect
    assert isinstance(told, BrighterFatter)
    assert member.course
    for value, std in (
        (told.row_per_e, member.std[0] / member.strength),
        (told.column_per_e, member.std[1 + list(member.inner).index("column_per_e")]),
    ):
        assert abs(np.log(value / PER_E)) < 4.5 * std
