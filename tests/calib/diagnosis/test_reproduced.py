"""Of an effect with a pattern of chance, its law of the signal is kept, in scenes as well."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.diagnose import responder_of
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.reproduced import PIECES, reproduced
from calib.diagnosis.naming.signatures import change_of
from calib.forward.effects.saturation_knee import SaturationKnee
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

COLUMNS, LINES = 512, 40
KNEE = SaturationKnee(threshold_e=20_000.0, room_e=60_000.0, relative_spread=1e-6)


def with_scene() -> Evidence:
    """Return flats and a scene of all lights up to theirs, neighbours unlike each other."""
    rows = [("dark", 300.0, 0.0), ("flat", 1000.0, 2.0), ("flat", 500.0, 2.0)]
    rows += [("flat", 1000.0, 1.0), ("scene", 1000.0, 0.0)]
    blocks = [
        Block(
            block=str(k), kind=kind, exposure_us=exposure, level=level, lines=LINES,
            scene="target" if kind == "scene" else None,
        )
        for k, (kind, exposure, level) in enumerate(rows)
    ]  # fmt: skip
    image = np.linspace(0.2, 2.2, COLUMNS)[default_rng().permutation(COLUMNS)]
    return recorded(plain_model(COLUMNS), blocks, default_rng(), scenes={"target": image})


def test_a_bend_that_sets_in_within_a_scene_is_kept() -> None:
    evidence = with_scene()
    first = evidence.baseline
    # As in a fit: links that step, each pixel's for itself, and means compared with the first.
    moved = replace(first, slope=first.slope * default_rng().normal(1.04, 0.01, first.slope.shape))
    responder = responder_of(evidence).about(moved)
    exact = responder.change((replace(KNEE, relative_spread=0.0),)).means
    kept = change_of((KNEE,), evidence, responder).means
    gain = float(first.gain_dn_per_e[0])
    piece = float((moved.slope * moved.dose).max()) / PIECES
    # A chord of a law whose second derivative is 1 / room at most, seen in DN, misses it by
    # piece^2 / (8 room); least squares, whose norm is 3 (Shadrin, Acta Math. 187, 59 (2001), for
    # straight pieces), by four times that.
    most = 4.0 * piece**2 / (8.0 * gain * KNEE.room_e)
    assert np.abs(exact - kept).max() < most
    assert np.ptp((exact - moved.slope.ravel() * moved.dose.reshape(exact.shape))[4]) > 100 * most


def test_links_that_a_fit_has_led_below_the_dark_have_a_profile_still() -> None:
    evidence = with_scene()
    base = evidence.baseline
    below = -2.0 * (base.mean_dn - base.offset_dn).reshape(len(base.mean_dn), -1) - 50.0
    change = change_of((KNEE,), evidence, responder_of(evidence))
    means = reproduced(change, change, evidence, below, exact=False).means
    assert np.isfinite(means).all()
