"""Effects that follow the signal, or taps, by laws of their own keep their names."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.diagnosis.diagnose import responder_of
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.remainder import unexplained_deviance
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.lag import Lag
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from calib.forward.taps import tap_of_column
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

NAMES = ("lag", "persistence", "nonlinearity", "saturation_knee")
COLUMNS = 128


@dataclass(frozen=True)
class Uneven(Lag):
    """Of charge q, exactly `staying(q)` stays."""

    def staying(self, charge: Lines) -> Lines:
        raise NotImplementedError

    def carried(
        self, signal: Lines, found: NDArray[Any], at: Conditions, rng: Generator
    ) -> tuple[Lines, Pixels]:
        kept, read = found, np.empty(signal.shape)
        for n, line in enumerate(signal):
            charge = line + kept
            # Whole electrons, each by itself, so that light stays Poisson-distributed.
            chance = self.staying(charge) / np.maximum(charge, 1.0)
            kept = rng.binomial(charge.astype(np.int64), chance).astype(float)
            read[n] = charge - kept
        return read, kept

    def expected_left(self, signal: Lines, at: Conditions) -> Pixels:
        return np.asarray(self.staying(signal[-1]))


class BehindABarrier(Uneven):
    """Only what lies above 8,000 electrons waits."""

    def staying(self, charge: Lines) -> Lines:
        return np.asarray(self.share * np.maximum(charge - 8000.0, 0.0))


class InTraps(Uneven):
    """Shallow traps that a large charge does not notice."""

    def staying(self, charge: Lines) -> Lines:
        return np.asarray(self.share * charge / (1.0 + charge / 4000.0))


class Toe(Nonlinearity):
    """What is missing at the bottom of the range, and fades as the signal grows."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        return np.asarray(signal * (1.0 - 0.02 * np.exp(-np.abs(signal) / 450.0)))


@pytest.mark.parametrize(
    "effect",
    [BehindABarrier(0.008), InTraps(0.02), Toe()],
    ids=lambda effect: type(effect).__name__,
)
def test_what_follows_the_signal_by_a_law_of_its_own_keeps_its_name(effect: Departure) -> None:
    rng = default_rng()
    evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (effect,))
    assert_alone(effect, evidence, NAMES)


def assert_alone(
    effect: Departure, evidence: Evidence, names: tuple[str, ...]
) -> tuple[Departure, ...]:
    """Assert that an effect is found, and nothing is left; return it as it was fitted."""
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in names for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    model = find(contest, beside(None, evidence))
    assert [m.effect.name for m in model.members] == [effect.name]
    assert unexplained_deviance(model, evidence) == 0.0
    return tuple(m.effect for m in model.members)


@pytest.mark.parametrize(("layout", "mirrored"), [("odd_even", False), ("halves", False)])
def test_what_a_partner_read_before_is_crosstalk_and_no_capacitance(
    layout: str, mirrored: bool
) -> None:
    rng, effect = default_rng(), TapCrosstalk(0.02, layout, mirrored, pixels_before=1)
    model = plain_model(COLUMNS, taps=2, layout=layout)
    evidence = recorded(model, plan(rng, 60), rng, (effect,))
    names = ("tap_crosstalk", "interpixel_capacitance", "brighter_fatter")
    [found] = assert_alone(effect, evidence, names)
    assert isinstance(found, TapCrosstalk)
    assert (found.pixels_before, found.mirrored) == (1, mirrored)


class OneWay(TapCrosstalk):
    """Every other tap sees its partner, which does not see it."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        sees = tap_of_column(self.tap_layout, signal.shape[-1]) % 2 == 0
        return np.asarray(np.where(sees, super().apply(signal, at, rng), signal))


def test_crosstalk_that_every_other_tap_sees_is_crosstalk_where_a_scene_shows_it() -> None:
    rng, effect = default_rng(), OneWay(0.007, "quarters")
    bar = np.where(np.abs(np.arange(COLUMNS) - 50.5) < 9, 3.0, 0.6)
    blocks = [*plan(rng, 60), Block(block="bar", kind="scene", scene="bar", exposure_us=1000.0,
                                    level=0.0, lines=60)]  # fmt: skip
    model = plain_model(COLUMNS, taps=4, layout="quarters")
    evidence = recorded(model, blocks, rng, (effect,), scenes={"bar": bar})
    assert_alone(effect, evidence, ("tap_crosstalk", "stray_light", "interpixel_capacitance"))
