"""Few noise-free lines stand for a block: its mean, its first lines, and its spectrum."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.simulation.sampled_lines import sampled_lines
from calib.diagnosis.statistics.peak import Peak
from calib.forward.effects.persistence import Persistence
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

COLUMNS, LINES = 32, 100
TRAPS = Persistence(0.02, 20.0, 4e5)
"""Bright light fills them within twenty lines or so."""


@pytest.fixture(scope="module")
def recording() -> Evidence:
    wanted = [("flat", 3.0, 900.0), ("dark", 0.0, 900.0), ("flat", 2.0, 900.0)]
    wanted += [("flat", 1.0, 900.0), ("dark", 0.0, 300.0), ("flat", 3.0, 300.0)]
    blocks = [
        Block(block=str(k), kind=kind, level=level, exposure_us=exposure, lines=LINES)
        for k, (kind, level, exposure) in enumerate(wanted)
    ]
    return recorded(plain_model(COLUMNS), blocks, np.random.default_rng(), (TRAPS,))


def test_a_few_lines_tell_what_traps_that_fill_do_to_all_of_them(recording: Evidence) -> None:
    chain = responder_of(recording).chain
    lefts = chain.left_before((TRAPS,))
    every = chain.stack([(b, np.arange(float(LINES))) for b in range(6)], "every").before(lefts)
    dn = chain.noise_free(every, (TRAPS,), 0)
    peak = Peak(0.03, 0, (), (), 0.0)
    for b, each in enumerate(sampled_lines(chain, (TRAPS,), lefts, 0)):
        change = dn[every.parts[b]] - chain.baseline.mean_dn[b].ravel()
        line = change.mean(axis=1)
        # A cubic's error is of the fourth order in how much traps fill from line to line looked at.
        error = 0.01 * np.ptp(line) + 1e-6
        assert np.abs((each.between @ each.change).mean(axis=1) - line).max() < 3.0 * error
        assert abs((each.weights @ each.change).mean() - line.mean()) < error
        first = line[:3] - line[LINES // 2 :].mean()
        assert np.abs((each.first @ each.change).mean(axis=1) - first).max() < error
        whole = peak.squared_amplitude(change - change.mean(axis=0))
        few = peak.squared_amplitude(each.change - each.weights @ each.change, each.between)
        assert few == pytest.approx(whole, rel=0.1, abs=1e-9)


def test_a_block_that_begins_otherwise_than_it_ends_has_power_at_low_frequencies(
    recording: Evidence,
) -> None:
    peak = Peak(0.03, 0, (), (), 0.0)
    tones = replace(responder_of(recording), peaks=(peak,)).change((TRAPS,)).tones[:, 0]
    clear = 0
    for b, each in enumerate(recording.sums):
        line = each.products.line_means.mean(axis=(1, 2))
        seen = peak.squared_amplitude((line - line.mean())[:, None])
        noise = 4.0 * recording.baseline.variance_dn2[b].mean() / (LINES * COLUMNS)
        # A square of A beside noise of power s scatters by sqrt(s^2 + 2 s A) about A + s.
        spread = np.sqrt(noise**2 + 2.0 * noise * tones[b])
        assert -6.0 < (seen - noise - tones[b]) / spread < 14.0
        clear += int(tones[b] > 10.0 * noise)
    assert clear > 0
