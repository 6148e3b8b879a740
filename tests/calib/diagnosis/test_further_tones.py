"""Overtones of a pattern stand out beside the tone that is fitted to it; a sine has none."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from calib.diagnosis.answer.rhythm import period_of, rhythm_of
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.look import Look
from calib.diagnosis.naming.model import Member
from calib.diagnosis.naming.remainder import CERTAIN_SIGMA, looks_at
from calib.diagnosis.shapes.shape import Shape
from calib.diagnosis.signatures.signature import Signature
from calib.diagnosis.statistics.further_tones import FurtherTone, tones_beside
from calib.diagnosis.statistics.peak import Peak
from calib.forward.departure import Departure
from calib.forward.effects.banding import Banding
from calib.forward.effects.lamp_flicker import LampFlicker
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

LINES = 64
SIGNAL = np.array([0.0, 100.0, 300.0, 700.0, 1000.0, 1500.0, 2000.0, 2500.0])
SHARED = 0.5 - 1.0 / 16.0
"""Of a sign that alternates, turned after each eight lines: 0.5 and an odd part of 1/16 off."""


def beside_one(wave: np.ndarray, size: np.ndarray, rng: Generator) -> tuple[FurtherTone, ...]:
    """Return what is told beside a tone of `SHARED`, of waves in noise of 1."""
    counter = np.arange(LINES) + rng.integers(0, 1000, (len(SIGNAL), 1))
    lines = size[:, None] * wave[counter % len(wave)] + rng.standard_normal((len(SIGNAL), LINES))
    return tones_beside([SHARED], list(lines), SIGNAL)


def test_a_sine_has_nothing_beside_it_however_strong() -> None:
    rng, runs = default_rng(), 60
    sine = np.sin(2.0 * np.pi * SHARED * np.arange(16))
    found = sum(
        bool(beside_one(sine, np.full(len(SIGNAL), size), rng))
        for size in (0.3, 3.0, 30.0)
        for _ in range(runs // 3)
    )
    # Chance reaches a deviance of 15 in 2 exp(-15 / 2) of them, 0.07: four once in 10^6 draws.
    assert found <= 3


@pytest.mark.parametrize("lit", [False, True])
def test_a_patterns_overtones_are_told_and_what_they_go_with(lit: bool) -> None:
    rng = default_rng()
    pattern = (-1.0) ** np.arange(16) * np.repeat([1.0, -1.0], 8)
    size = 4.0 * (SIGNAL / SIGNAL.mean() if lit else np.ones(len(SIGNAL)))
    found = sorted(beside_one(pattern, size, rng), key=lambda tone: -tone.power.sum())
    # Overtone k has 1 / sin^2(pi k / 16) of the power.
    for tone, k in zip(found[:3], (3.0, 5.0, 7.0), strict=True):
        assert abs(tone.cycles_per_line - (0.5 - k / 16.0)) < 0.5 / LINES or k > 3.0
        nearest = np.abs(0.5 - np.array([3.0, 5.0, 7.0]) / 16.0 - tone.cycles_per_line).min()
        assert nearest < 0.5 / LINES
        assert tone.goes_with_light is lit
    assert period_of([tone.cycles_per_line for tone in found[:3]], LINES) == 16
    # Of a pattern of 1, 2 / 16^2 / sin^2(pi k / 16) times 2^2, folded, is in each of its tones.
    share = 2.0 * (2.0 / 16.0 / np.sin(np.pi * 3.0 / 16.0)) ** 2
    square = share * float((size**2).mean())
    # An amplitude a scatters by sqrt(2 / n), a^2 / 2 by a times that; overtones leak.
    std = np.sqrt(2.0 / LINES) * np.sqrt(2.0 * square / len(size))
    assert abs(found[0].square_dn2 - square) < 0.1 * square + 6.0 * std


def turning(lit: bool) -> Evidence:
    """Return a recording whose lines' means have the pattern, and a peak for its strongest tone."""
    rng, lines = default_rng(), 64
    evidence = recorded(plain_model(64), plan(rng, lines, twice=0), rng)
    sign = (-1.0) ** np.arange(lines) * np.resize(np.repeat([1.0, -1.0], 8), lines)
    sums = []
    for each, signal in zip(evidence.sums, evidence.signal_dn, strict=True):
        # The means of 64 pixels scatter by 1/8 of a pixel's noise.
        size = 0.5 * float(each.sigma_dn.mean()) * (signal / 400.0 if lit else 1.0)
        products = each.products
        moved = products.line_means + size * sign[:, None, None]
        sums.append(replace(each, products=replace(products, line_means=moved)))
    n = evidence.n_blocks
    peak = Peak(SHARED, 0, tuple(np.full(n, 30.0)), tuple(np.ones(n)), 1000.0)
    return replace(evidence, sums=tuple(sums), known_peaks=(peak,))


def rhythm(evidence: Evidence, effect: Departure | None = None) -> list[Look]:
    """Return the looks at rhythms, with an effect in the model that has taken the peak, if any."""
    model = beside(None, evidence)
    if effect is not None:
        left = model.residual.rest.copy()
        left[evidence.whitening.places["tones"]] = 0.0
        point = replace(model.residual, rest=left)
        shape = Shape(effect, (), two_sided=False)
        member = Member(
            Signature(shape, 1.0, model.observed, point, 1.0, 1.0), 1.0, {}, (1.0,), (), ()
        )
        model = replace(model, residual=point, members=(member,))
    return [look for look in looks_at(model, evidence) if look.depends_on == ("line",)][-2:]


@pytest.mark.parametrize("lit", [False, True])
def test_overtones_stay_unexplained_but_of_light_that_flickers(lit: bool) -> None:
    evidence = turning(lit)
    assert "repeats after 16 lines" in rhythm_of(evidence)
    unclaimed, overtones = rhythm(evidence)
    assert unclaimed.freedom == evidence.n_blocks
    assert min(unclaimed.sigma(0.0, 20), overtones.sigma(0.0, 20)) > CERTAIN_SIGMA
    beside_banding, beside_flicker = (rhythm(evidence, e)[-1] for e in (Banding(), LampFlicker()))
    assert beside_banding.deviance == overtones.deviance
    assert (beside_flicker.deviance == overtones.deviance) is not lit
