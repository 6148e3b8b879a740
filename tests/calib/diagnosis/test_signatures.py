"""Signatures against long recordings with and without the effect, drawn by the forward model."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.stats import chi2

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.departure import Departure
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.cti import Cti
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.exposure_jitter import ExposureJitter
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lag import Lag
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.persistence import Persistence
from calib.forward.effects.stuck_bit import StuckBit
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

COLUMNS, LINES = 64, 1500
EFFECTS = (
    Nonlinearity(3e-6),
    InterpixelCapacitance(0.02),
    BrighterFatter(2e-6),
    TapCrosstalk(0.02, "odd_even"),
    TapCrosstalk(0.02, "odd_even", pixels_before=1),
    Lag(0.005),
    Lag(0.005, 0.0),
    Cti(3e-4, exponent=1.5, partition_noise=0.0, tap_layout="odd_even"),
    Cti(3e-4),
    Persistence(0.003, 8.0),
    Persistence(0.006, 8.0, 3e6),
    ExposureJitter(0.001),
    LineNoise(0.4),
    LineNoise(0.4, each_tap=True, tap_layout="odd_even"),
    StuckBit(0.02, 4, 1),
    # Of 28 DN^2 of noise, 28 DN are left out: jumps of 32 are in the one time, out the other.
    StuckBit(0.1, 5, 1),
    StuckBit(0.02, 5, 0),
    StuckBit(0.02, 8, 0),
    StuckBit(0.3, 1, 1),
    BlackClip(63),
    BlackClip(64, 0.5),
    BlackClip(64, only_tap=1, tap_layout="odd_even"),
)


def blocks() -> list[Block]:
    wanted = [("flat", 3.0, 900.0), ("dark", 0.0, 900.0), ("flat", 1.0, 300.0)]
    wanted += [("flat", 2.0, 900.0), ("dark", 0.0, 300.0), ("flat", 3.0, 300.0)]
    return [
        Block(block=str(k), kind=kind, level=level, exposure_us=exposure, lines=LINES)
        for k, (kind, level, exposure) in enumerate(wanted)
    ]


@cache
def plain() -> Evidence:
    return recorded(plain_model(COLUMNS, taps=2, layout="odd_even"), blocks(), default_rng())


def with_effect(effect: Departure) -> Evidence:
    model = plain_model(COLUMNS, taps=2, layout="odd_even")
    return recorded(model, blocks(), default_rng(), (effect,))


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda e: f"{e.name}")
def test_a_signature_is_what_long_recordings_show(effect: Departure) -> None:
    first, other = replace(plain(), known_peaks=()), with_effect(effect)
    recording = replace(first, sums=other.sums)
    seen = recording.observed() - first.observed()
    # What lies far out of a recording is left out by how its own samples scatter.
    signature = change_of((effect,), recording, responder_of(first))
    std = np.hypot(first.pooled.std, other.pooled.std)
    usable = np.isfinite(std) & (std > 0)
    for kind, where in first.pooled.places.items():
        fine = usable[:, where]
        if fine.any():
            z = ((seen.pooled - signature.pooled)[:, where] / std[:, where])[fine]
            # Twelve effects of a dozen kinds: by chance once in 5,000 runs.
            assert abs(z.mean()) < 5.0 / np.sqrt(z.size), kind
            assert (z**2).sum() < chi2.isf(1e-6, z.size), kind
    white = (first.baseline.variance_dn2 + other.baseline.variance_dn2) / LINES
    shared = first.common.fixed_dn2 + other.common.fixed_dn2
    shared = shared + other.common.relative * first.signal_dn[:, None, None] ** 2
    missed = (seen.means - signature.means).reshape(white.shape)
    z = missed.mean(axis=(1, 2)) / np.sqrt((white / COLUMNS + shared / LINES).mean(axis=(1, 2)))
    assert np.abs(z).max() < 5.0
    # Taps' gains are fitted, to 0.3 %: slopes take what that makes of columns' light.
    own = (missed - missed.mean(axis=2, keepdims=True)).reshape(len(white), -1)
    z = first.space.project(own) / np.sqrt(2.0)
    assert (z**2).sum() < chi2.isf(1e-6, first.space.degrees_of_freedom)


@pytest.mark.parametrize(
    "effect", [DarkCurrent(0.02, 0.0, dsnu_seed=3), HeavyTailedNoise(0.01)], ids=lambda e: e.name
)
def test_where_links_have_moved_their_means_move_along_pixel_by_pixel(effect: Departure) -> None:
    evidence = plain()
    responder, base = responder_of(evidence), evidence.baseline
    moved_dn = default_rng().normal(0.2, 0.1, base.offset_dn.shape)
    moved = replace(base, offset_dn=base.offset_dn + moved_dn)
    before = change_of((effect,), evidence, responder).means
    after = change_of((effect,), evidence, responder.about(moved)).means
    # Neither effect hangs on the offset: what is left is how two draws are smoothed along signals
    # that have moved, and less than a tenth of the 0.05 DN by which a mean scatters.
    added = after - before - moved_dn.reshape(1, -1)
    np.testing.assert_allclose(added, 0.0, atol=0.005)
