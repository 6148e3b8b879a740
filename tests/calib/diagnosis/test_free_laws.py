"""Lag whose share hangs on the charge is lag, and a bend at the bottom a nonlinearity."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from calib.arrays import Lines, Pixels
from calib.diagnosis.diagnose import responder_of, scales_of
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.remainder import unexplained_deviance
from calib.diagnosis.naming.search import find
from calib.diagnosis.naming.shapes import shapes_of
from calib.diagnosis.naming.signatures import signature
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.lag import Lag
from calib.forward.effects.nonlinearity import Nonlinearity
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
    responder = responder_of(evidence)
    scales = scales_of(evidence, responder)
    shapes = [shape for name in NAMES for shape in shapes_of(effect_named(name), scales)]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    model = find(contest, beside(None, evidence))
    assert [m.effect.name for m in model.members] == [effect.name]
    assert unexplained_deviance(model, evidence) == 0.0
