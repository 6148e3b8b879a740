"""What a tone does to second moments is its own, and nothing of the few lines' noise."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.derivatives import differentiated
from calib.diagnosis.naming.model import Member
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.signature import signature
from calib.diagnosis.simulation import tone_lines
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.diagnosis.simulation.opposite_tone import opposite_tone
from calib.diagnosis.statistics.tones import Peak
from calib.forward.effects.banding import Banding
from calib.forward.effects.lag import Lag
from calib.forward.effects.lamp_flicker import LampFlicker
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS, LINES = 96, 100
CYCLES = 7.3
KINDS = ("variance", "columns_1", "lines_1")


@cache
def plain() -> Evidence:
    rng = default_rng()
    return recorded(plain_model(COLUMNS), plan(rng, LINES, twice=0), rng)


def moved(amplitude_dn: float) -> np.ndarray:
    evidence = plain()
    tone = Banding(amplitude_dn, CYCLES / (evidence.table.line_period_us * 1e-6))
    change = change_of((tone,), evidence, responder_of(evidence)).pooled
    return np.concatenate([change[:, evidence.pooled.places[kind]].ravel() for kind in KINDS])


def test_a_tones_second_moments_grow_as_its_amplitude_squared() -> None:
    weak, strong = moved(0.02), moved(2.0)
    assert np.abs(strong).max() > 1e-3
    # Chance products with noise would grow as the amplitude, and be a hundred times as large.
    np.testing.assert_allclose(weak * 1e4, strong, atol=0.01 * np.abs(strong).max())


@pytest.mark.parametrize("phase_rad", [-6.0, 0.0, 1.0, 6.0])
def test_a_tone_and_its_opposite_cancel(phase_rad: float) -> None:
    tone = Banding(1.0, 12_345.0, phase_rad)
    half = opposite_tone(tone)
    assert np.cos(half.phase_rad - phase_rad) == pytest.approx(-1.0)
    assert opposite_tone(Lag(0.01)) == Lag(0.01)


def beside_a_peak(cycles_per_line: float, between: float = 0.0) -> Evidence:
    """Return the recording as if a peak had been seen."""
    n = plain().n_blocks
    peak = Peak(cycles_per_line, 0, (1.0,) * n, (1e-3,) * n, 100.0, between, n_lines=LINES)
    return replace(plain(), known_peaks=(peak,))


def test_what_a_tone_shares_with_noise_is_told_by_its_peak_alone() -> None:
    line = 0.2
    evidence = beside_a_peak(line)
    period_s = evidence.table.line_period_us * 1e-6
    there, elsewhere = (
        energies(LampFlicker(0.01, f / 2 / period_s), evidence) for f in (line, 0.3)
    )
    shared = ("common", "common_1", "common_2")
    assert there["tones"] > 0.0
    assert all(there[kind] == 0.0 for kind in shared)
    assert all(elsewhere[kind] > 0.0 for kind in shared)


def energies(effect: LampFlicker, evidence: Evidence) -> dict[str, float]:
    """Return the squared length of the derivative by the strength in each kind of statistic."""
    responder = responder_of(evidence)
    shape = Shape(effect, (("amplitude", effect.amplitude, 0.0),), two_sided=False)
    one = signature(shape, evidence, responder)
    assert one is not None
    member = Member(one, 1.0, {}, (), (), ())
    change = change_of((member.effect,), evidence, responder)
    slope = differentiated(0, [member], change, evidence, responder).directions[0]
    return evidence.whitening.energies(slope)


def test_few_lines_tell_what_all_of_them_have_beside_a_tone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    line, between = 0.2, 0.25 / LINES
    evidence = beside_a_peak(line, between)
    hz = (line + between) / 2.0 / (evidence.table.line_period_us * 1e-6)
    responder = responder_of(evidence)
    whole = change_of((LampFlicker(0.01, hz),), evidence, responder).tones
    lit = whole > 0.1 * whole.max()
    monkeypatch.setattr(tone_lines, "SAMPLES", 0)
    few = change_of((LampFlicker(0.01, hz),), evidence, responder_of(evidence)).tones
    # Of few lines a tone's mirror image is nearer.
    np.testing.assert_allclose(few[lit], whole[lit], rtol=0.05)
