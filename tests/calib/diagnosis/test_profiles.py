"""Light and dark current that differ along the columns are still what they are called."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.random import default_rng

from calib.arrays import Lines, Pixels, SampleShape
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.contribution import contribution
from calib.diagnosis.naming.model import Member, Model
from calib.diagnosis.naming.remainder import unexplained_deviance
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effects.amplifier_glow import AmplifierGlow
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.stray_light import StrayLight
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

NAMES = (
    "stray_light",
    "level_nonadditivity",
    "exposure_offset",
    "dark_current",
    "amplifier_glow",
    "lamp_drift",
)
COLUMNS = 128


def found_in(evidence: Evidence, names: Sequence[str] = NAMES) -> Model:
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in names for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    return find(contest, beside(None, evidence))


def product_of(member: Member, evidence: Evidence) -> float:
    """Return the deviance that a member makes by itself."""
    point = contribution(member)
    return evidence.product(point, point)


class LeaksInAtOneEnd(StrayLight):
    """It has fallen to exp(-5) at the other."""

    def apply(self, signal: Lines, at: Conditions, rng: np.random.Generator) -> Lines:
        profile = 5.0 * np.exp(-5.0 * np.linspace(0.0, 1.0, signal.shape[-1]))
        return signal + (0.0 if at.capped else self.radiance * profile)


class BreathesWithTheLevel(StrayLight):
    """The source's shading changes with its level: light that grows as the level's square."""

    def apply(self, signal: Lines, at: Conditions, rng: np.random.Generator) -> Lines:
        middle = np.cos(np.pi * np.linspace(-1.0, 1.0, signal.shape[-1]))
        return signal * (1.0 + self.radiance * middle * signal.mean())


class WarmerAtOneEnd(DarkCurrent):
    """One end gathers nine times as much as the other."""

    def rates(self, sample: SampleShape) -> Pixels:
        return np.asarray(super().rates(sample) * np.linspace(0.2, 1.8, COLUMNS))


class FarGlow(AmplifierGlow):
    """Light that falls as the square of the distance."""

    def rates(self, sample: SampleShape) -> Pixels:
        distance = np.arange(COLUMNS) / self.decay_columns
        return np.asarray(self.electrons_per_us / (1.0 + distance) ** 2)


@pytest.mark.parametrize(
    "effect",
    [
        LeaksInAtOneEnd(0.03),
        WarmerAtOneEnd(electrons_per_us=0.05, dsnu_std_e_per_us=0.0),
    ],
    ids=lambda effect: effect.name,
)
def test_a_profile_over_the_columns_is_one_name_and_nothing_beside_it(effect: Departure) -> None:
    rng = default_rng()
    evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (effect,))
    model = found_in(evidence)
    assert [m.effect.name for m in model.members] == [effect.name]
    assert unexplained_deviance(model, evidence) == 0.0


def test_a_glow_by_another_law_is_no_gradient_of_dark_current() -> None:
    rng = default_rng()
    effect = FarGlow(electrons_per_us=0.5, decay_columns=12.0)
    evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (effect,))
    model = found_in(evidence)
    # What falls as the square falls more slowly far away: a little dark current may be beside it.
    gains = {m.effect.name: product_of(m, evidence) for m in model.members}
    assert max(gains, key=lambda name: gains[name]) == "amplifier_glow"


def test_a_shading_that_changes_with_the_level_has_no_name() -> None:
    rng = default_rng()
    effect = BreathesWithTheLevel(0.0025)
    evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (effect,))
    model = found_in(evidence)
    # What is left of it by light of any profile is smooth: among all pixels it would be chance.
    assert not model.members
    assert unexplained_deviance(model, evidence) > 0.0
