"""Of an effect with a pattern of chance, its law of the signal is kept, in scenes as well."""

from dataclasses import replace

import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.signatures.changes import change_of
from calib.diagnosis.signatures.reproduced import PIECES, reproduced
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.forward.effects.saturation_knee import SaturationKnee
from calib.forward.effects.tap_gain_drift import TapGainDrift
from calib.recording.header import Block
from tests.calib.diagnosis.recordings import plain_model, recorded

COLUMNS, LINES = 512, 40
KNEE = SaturationKnee(threshold_e=20_000.0, room_e=60_000.0, relative_spread=1e-6)


def with_scene(taps: int = 1) -> Evidence:
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
    model = plain_model(COLUMNS, taps=taps, layout="single" if taps == 1 else "odd_even")
    return recorded(model, blocks, default_rng(), scenes={"target": image})


def test_a_bend_that_sets_in_within_a_scene_is_kept() -> None:
    evidence = with_scene()
    first = evidence.baseline
    # As in a fit: links that step, each pixel's for itself, and means compared with the first.
    moved = replace(first, slope=first.slope * default_rng().normal(1.04, 0.01, first.slope.shape))
    responder = responder_of(evidence).about(moved)
    exact = responder.change((replace(KNEE, relative_spread=0.0),)).means
    kept = change_of((KNEE,), evidence, responder).means
    gain = float(first.gain_dn_per_e[0])
    signal = (moved.slope * moved.dose).reshape(exact.shape)
    piece = float(signal.max()) / PIECES
    # A chord of a law whose second derivative is 1 / room at most, seen in DN, misses it by
    # piece^2 / (8 room); least squares, whose norm is 3 (Shadrin, Acta Math. 187, 59 (2001), for
    # straight pieces), by four times that.
    most = 4.0 * piece**2 / (8.0 * gain * KNEE.room_e)
    # The last piece's end hangs on the few pixels there, and follows them farther than that norm.
    assert np.abs(exact - kept)[signal < signal.max() - piece].max() < most
    assert np.ptp((exact - signal)[4]) > 100 * most


def test_what_no_chance_has_a_part_in_is_kept_beside_a_pattern_of_chance() -> None:
    evidence = with_scene(taps=2)
    first = evidence.baseline
    # Of both taps, so that a knee sets in at one signal.
    gain = np.full_like(first.gain_dn_per_e, first.gain_dn_per_e.mean())
    responder = responder_of(evidence).about(replace(first, gain_dn_per_e=gain))
    drift = TapGainDrift((0.02, -0.02), time_constant_s=1.0)
    bent = responder.change((replace(KNEE, relative_spread=0.0),)).means
    exact = responder.change((replace(KNEE, relative_spread=0.0), drift)).means
    kept = change_of((KNEE, drift), evidence, responder).means
    piece = float((first.slope * first.dose).max()) / PIECES
    chord = 4.0 * piece**2 / (8.0 * float(gain[0]) * KNEE.room_e)
    # The taps' gains scale what the knee takes, too, and pixels of one signal get the mean of both:
    # least squares of norm 3 of what differs by 2 % from tap to tap.
    most = 1.02 * chord + 4.0 * 0.02 * np.abs(bent).max()
    assert np.abs(exact - kept).max() < most
    # As much as is left where a profile is drawn through both taps.
    assert 0.02 * float((first.slope * first.dose).max()) > 2.0 * most


def test_links_that_a_fit_has_led_below_the_dark_have_a_profile_still() -> None:
    evidence = with_scene()
    base = evidence.baseline
    below = -2.0 * (base.mean_dn - base.offset_dn).reshape(len(base.mean_dn), -1) - 50.0
    change = change_of((KNEE,), evidence, responder_of(evidence))
    means = reproduced(change, change, evidence, below, below, exact=False).means
    assert np.isfinite(means).all()
