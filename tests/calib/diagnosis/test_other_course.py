"""A gain of one tap that follows the signal is no drift of it, in whatever order signals come."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.arrays import Lines
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.remainder import unexplained_deviance
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.conditions import Conditions
from calib.forward.effects.catalogue import effect_named
from calib.forward.effects.tap_gain_drift import TapGainDrift
from calib.forward.taps import by_tap
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

LAYOUT = "odd_even"
LASTS_S = 3.0
"""The recording: each block takes about a sixth of a second."""


class FollowsTime(TapGainDrift):
    """It comes and goes."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        return self._with(signal, float(np.sin(2.0 * np.pi * at.line_times_s.mean() / LASTS_S)))

    def _with(self, signal: Lines, share: float) -> Lines:
        return signal * (1.0 + share * by_tap(self.amplitude, LAYOUT, signal.shape[1:]))


class FollowsTheSignal(FollowsTime):
    """It is as large as the signal."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        return self._with(signal, float(signal.mean()) / 3000.0)


@pytest.mark.parametrize("kind", [FollowsTime, FollowsTheSignal])
def test_a_gain_that_follows_the_signal_is_no_drift(kind: type[TapGainDrift]) -> None:
    rng = default_rng()
    blocks = sorted(plan(rng, 60, twice=0), key=lambda b: (b.exposure_us, -b.level))
    model = plain_model(128, taps=2, layout=LAYOUT)
    evidence = recorded(model, blocks, rng, (kind((-0.01, 0.01), tap_layout=LAYOUT),))
    responder = responder_of(evidence)
    shapes = shapes_of(effect_named("tap_gain_drift"), scales_of(evidence, responder))
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    named = find(contest, beside(None, evidence))
    drifts = kind is FollowsTime
    assert [m.effect.name for m in named.members] == (["tap_gain_drift"] if drifts else [])
    assert (unexplained_deviance(named, evidence) > 0.0) is not drifts
