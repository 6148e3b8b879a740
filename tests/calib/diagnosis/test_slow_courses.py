"""A block that begins otherwise than it ends has power at low frequencies, and no tone."""

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.search import find
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.persistence import Persistence
from tests.calib.diagnosis.recordings import plain_model, plan, recorded
from tests.calib.diagnosis.test_search import contest_of

COLUMNS, LINES = 256, 64
TRAPS = Persistence(0.02, 4.0, 4e5)
"""Bright light fills them within twenty lines or so."""


def test_traps_that_fill_leave_no_flicker_beside_them() -> None:
    rng = default_rng()
    evidence = recorded(plain_model(COLUMNS), plan(rng, LINES, twice=0), rng, (TRAPS,))
    assert evidence.peaks, "a peak for the flicker to be told from"
    contest = contest_of(evidence, ("persistence", "lamp_flicker", "banding", "lag"))
    model = find(contest, beside(None, evidence))
    assert [member.effect.name for member in model.members] == ["persistence"]
    # The peak was chosen for its height, and is no measure of the strength.
    assert not any(np.any(change.tones) for change in model.members[0].changes)
    assert responder_of(evidence).change((TRAPS,)).tones.max() > 0.0
