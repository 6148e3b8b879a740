import numpy as np
from numpy.random import default_rng

from calib.diagnosis.evidence.jumping import expected_variance, jumping_pixels
from calib.diagnosis.evidence.pixel_scatter import lasting_scatter
from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.shapes.told_shapes import told_shapes
from calib.diagnosis.statistics.gather import block_sums
from calib.diagnosis.statistics.rare import RARE
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.rts_pixels import RtsPixels
from calib.recording.header import CameraHeader
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS = 128


def test_pixels_that_jump_are_found_and_their_variance_is_theirs() -> None:
    z = []
    for rng in default_rng().spawn(3):
        jumping = RtsPixels(amplitude_dn=9.0, share=0.03, dwell_up_s=0.002, dwell_down_s=0.004)
        evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (jumping,))
        found = jumping_pixels(evidence)
        assert found.pixels.tolist() == jumping.pixels((COLUMNS,)).tolist()
        shape = told_shapes(evidence)["rts_pixels"][0].template
        assert isinstance(shape, RtsPixels)
        assert shape.share == len(found.pixels) / COLUMNS
        up = jumping.up_share
        z.append(found.variance_dn2 / (81.0 * up * (1.0 - up)) - 1.0)
    off = np.concatenate(z)
    assert abs(off.mean()) < 5.0 * off.std(ddof=1) / np.sqrt(len(off))


def test_no_pixel_jumps_where_single_samples_are_far_out_or_dark_current_is_noisy() -> None:
    others = (
        (),
        (CosmicRays(per_pixel_s=0.5, electrons=4000.0),),
        (HeavyTailedNoise(share=2e-3, std_e=400.0),),
        (HotPixels(pixels=(7, 30, 88), rates_e_per_us=(2.0, 5.0, 3.0)),),
    )
    for rng, effects in zip(default_rng().spawn(len(others)), others, strict=True):
        evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, effects)
        assert len(jumping_pixels(evidence).pixels) == 0
        assert told_shapes(evidence)["rts_pixels"] == ()


def test_what_a_noisy_pixel_does_is_no_accident_of_single_samples() -> None:
    lines = np.rint(default_rng().normal(300.0, 2.0, (80, 1, 64))).astype(np.int64)
    lines[10, 0, 5], lines[30, 0, 9] = 320, 320
    events = block_sums(
        lines.astype(np.uint16), Sensor(CameraHeader(columns=64, bit_depth=12)), 1 << 16
    ).events
    above = RARE.index("above")
    assert (events.counts()[above], events.counts((5,))[above]) == (2.0, 1.0)


def test_two_dark_blocks_tell_jumps_that_the_noise_of_light_hides() -> None:
    for rng in default_rng().spawn(3):
        blocks = plan(rng, 80, twice=0)
        dark = next(block for block in blocks if block.kind == "dark")
        flats = [block for block in blocks if block.kind == "flat" and block.exposure_us > 300.0]
        kept = [flats[0], dark, *flats[1:], dark.model_copy(update={"block": "again"})]
        # A scatter of 2.5 DN beside 1.2 DN of noise in the dark, and 7 to 17 DN in the light.
        jumping = RtsPixels(amplitude_dn=5.0, share=0.03, dwell_up_s=0.001, dwell_down_s=0.001)
        found = jumping_pixels(recorded(plain_model(COLUMNS), kept, rng, (jumping,)))
        assert found.pixels.tolist() == jumping.pixels((COLUMNS,)).tolist()


def test_jumps_that_last_for_lines_are_found_where_their_variance_alone_is_too_little() -> None:
    found, told = 0, 0
    for rng in default_rng().spawn(4):
        # A scatter of 0.85 DN beside 1.2 DN of noise; four fifths of it last to the next line.
        jumping = RtsPixels(amplitude_dn=1.7, share=0.03, dwell_up_s=0.015, dwell_down_s=0.015)
        evidence = recorded(plain_model(COLUMNS), plan(rng, 60), rng, (jumping,))
        pixels, places = jumping_pixels(evidence).pixels, jumping.pixels((COLUMNS,))
        assert np.isin(pixels, places).all()
        found, told = found + len(pixels), told + len(places)
    # Two in three, where variances alone tell one in seven.
    assert found > told / 5


def test_sums_of_products_of_lines_are_normal_numbers_by_chance() -> None:
    z = []
    for rng in default_rng().spawn(3):
        evidence = recorded(plain_model(COLUMNS), plan(rng, 24), rng, ())
        z.append(lasting_scatter(evidence, expected_variance(evidence)).sigma)
    every = np.concatenate(z)
    # Less than 1, for lines about their mean hold less than so many of noise.
    assert 0.7 < every.std() < 1.15
    assert np.abs(every).max() < 5.5
