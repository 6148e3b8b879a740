"""A tone of the electronics runs on within a line; an offset of whole lines is none."""

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.arrays import Lines, by_line
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA, worst
from calib.diagnosis.naming.search import find
from calib.diagnosis.shapes.of_effects import shapes_of
from calib.diagnosis.signatures.looked_for import scales_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.conditions import Conditions
from calib.forward.effects.banding import Banding
from calib.forward.effects.catalogue import effect_named
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

NAMES = ("banding", "lamp_flicker", "line_noise")
CYCLES_PER_LINE = 0.373


class StepsFromLineToLine(Banding):
    """All pixels of a line are off by as much."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        turns = 2.0 * np.pi * self.frequency_hz * at.line_times_s
        return np.asarray(signal + self.amplitude_dn * by_line(np.sin(turns), signal.ndim))


@pytest.mark.parametrize("kind", [Banding, StepsFromLineToLine])
def test_what_steps_from_line_to_line_is_no_banding(kind: type[Banding]) -> None:
    rng, model = default_rng(), plain_model(64)
    effect = kind(1.0, CYCLES_PER_LINE / (model.camera.line_period_us * 1e-6))
    evidence = recorded(model, plan(rng, 64), rng, (effect,))
    responder = responder_of(evidence)
    shapes = [s for n in NAMES for s in shapes_of(effect_named(n), scales_of(evidence, responder))]
    found = [signature(shape, evidence, responder) for shape in shapes]
    contest = Contest(tuple(s for s in found if s is not None), evidence, responder)
    named = find(contest, beside(None, evidence))
    runs_on = kind is Banding
    assert [m.effect.name for m in named.members] == (["banding"] if runs_on else [])
    assert (worst(named, evidence)[1] > CERTAIN_SIGMA) is not runs_on
