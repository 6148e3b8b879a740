"""Effects of neighbours whose law is left free: one name, and its strengths those of the noise."""

import numpy as np
from numpy.random import Generator, default_rng

from calib.arrays import Lines
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.conditions import Conditions
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

NAMES = ("brighter_fatter", "interpixel_capacitance", "nonlinearity")
PER_E = 4e-6
COLUMNS = 256


def found_in(evidence: Evidence) -> Model:
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in NAMES for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    return find(contest, beside(None, evidence))


class OwnFlux(BrighterFatter):
    """Pixels send away what comes to themselves: profiles lose twice as much for the same noise."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        moved = super().apply(signal, at, rng)
        return moved + (moved - signal).mean(axis=0)


def test_charge_repelled_alike_along_rows_and_columns_is_brighter_fatter_alone() -> None:
    model = plain_model(48, rows=12)
    rng = default_rng()
    effect = OwnFlux(row_per_e=PER_E, column_per_e=PER_E, corner_per_e=0.0)
    (member,) = found_in(recorded(model, plan(rng, 60), rng, (effect,))).members
    told = member.effect
    assert isinstance(told, BrighterFatter)
    assert member.course
    for value, std in (
        (told.row_per_e, member.std[0] / member.strength),
        (told.column_per_e, member.std[1 + list(member.inner).index("column_per_e")]),
    ):
        assert abs(np.log(value / PER_E)) < 4.5 * std


class EveryOtherPair(InterpixelCapacitance):
    """Columns 1 and 2, 3 and 4 ... share a contact; those between do not couple."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        flow = 2.0 * self.column_coupling * np.diff(signal, axis=-1)
        flow[..., ::2] = 0.0
        coupled = np.array(signal, np.float64)
        coupled[..., :-1] += flow
        coupled[..., 1:] -= flow
        return coupled


def test_columns_that_couple_in_pairs_are_named_where_a_scene_shows_which() -> None:
    rng, coupling = default_rng(), 0.02
    # Both edges lie between columns that do not couple.
    bar = np.where(np.abs(np.arange(COLUMNS) - 100.5) < 20, 3.0, 0.6)
    blocks = [*plan(rng, 60), Block(block="bar", kind="scene", scene="bar", exposure_us=1000.0,
                                    level=0.0, lines=60)]  # fmt: skip
    effect = EveryOtherPair(column_coupling=coupling)
    evidence = recorded(plain_model(COLUMNS), blocks, rng, (effect,), scenes={"bar": bar})
    (member,) = found_in(evidence).members
    told = member.effect
    assert isinstance(told, InterpixelCapacitance)
    assert member.course
    # Half of the pairs covary twice as much: the mean coupling is told.
    assert abs(told.column_coupling - coupling) < 4.5 * member.std[0] * coupling / member.strength


class FarReaching(BrighterFatter):
    """Columns two apart repel each other, too, half as much as neighbours."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        moved = np.array(super().apply(signal, at, rng))
        far = BrighterFatter(row_per_e=0.5 * self.row_per_e)
        for every_other in (slice(0, None, 2), slice(1, None, 2)):
            apart = signal[..., every_other]
            moved[..., every_other] += far.apply(apart, at, rng) - apart
        return moved


def test_charge_repelled_two_columns_on_is_brighter_fatter_alone_where_a_scene_shows_it() -> None:
    rng = default_rng()
    bar = np.where(np.arange(COLUMNS) % 9 < 4, 3.0, 0.6)
    blocks = [*plan(rng, 60), Block(block="bar", kind="scene", scene="bar", exposure_us=1000.0,
                                    level=0.0, lines=60)]  # fmt: skip
    effect = FarReaching(row_per_e=2.0 * PER_E)
    evidence = recorded(plain_model(COLUMNS), blocks, rng, (effect,), scenes={"bar": bar})
    assert [m.effect.name for m in found_in(evidence).members] == ["brighter_fatter"]
