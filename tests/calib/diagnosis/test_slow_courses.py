"""A block that begins otherwise than it ends has power at low frequencies, and no tone."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.search import find
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.statistics.block_sums import PADDING
from calib.diagnosis.statistics.peak import Peak
from calib.forward.effects.persistence import Persistence
from tests.calib.diagnosis.recordings import plain_model, plan, recorded
from tests.calib.diagnosis.test_search import contest_of

COLUMNS, LINES = 256, 64
TRAPS = Persistence(0.02, 4.0, 4e5)
"""Bright light fills them within twenty lines or so."""


def slow_peak(evidence: Evidence) -> Peak:
    """Return the power of two cycles a block as a peak, which the courses' own level may hide."""
    k = 2 * PADDING
    powers = np.stack([each.power for each in evidence.sums])
    floors = np.median(powers[:, :, 0], axis=1) / np.log(2.0)
    scale = 4.0 / (LINES * COLUMNS)
    values = (powers[:, k, 0] - floors) * scale
    return Peak(k / powers.shape[1], 0, tuple(values), tuple(floors * scale), 100.0)


def test_traps_that_fill_leave_no_flicker_beside_them() -> None:
    rng = default_rng()
    found = recorded(plain_model(COLUMNS), plan(rng, LINES, twice=0), rng, (TRAPS,))
    evidence = replace(found, known_peaks=(slow_peak(found),))
    contest = contest_of(evidence, ("persistence", "lamp_flicker", "banding", "lag"))
    model = find(contest, beside(None, evidence))
    assert [member.effect.name for member in model.members] == ["persistence"]
    # The peak was chosen for its height, and is no measure of the strength.
    assert not any(np.any(change.tones) for change in model.members[0].changes)
    assert responder_of(evidence).change((TRAPS,)).tones.max() > 0.0
