import numpy as np
from numpy.random import default_rng

from calib.diagnosis.shapes.told_shapes import told_shapes
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.rts_pixels import RtsPixels
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

PIXELS = (7, 30, 31, 88, 110)
RATES = (0.15, 0.2, 0.3, 0.25, 0.6)


def test_hot_pixels_are_found_and_their_rates_scatter_as_they_should() -> None:
    z = []
    for rng in default_rng().spawn(4):
        hot = HotPixels(pixels=PIXELS, rates_e_per_us=RATES)
        evidence = recorded(plain_model(128), plan(rng, 60), rng, (hot,))
        growing = evidence.growing
        assert growing is not None
        assert growing.pixels.tolist() == list(PIXELS)
        direction = evidence.space.project(
            np.broadcast_to(evidence.table.exposure_us[:, None], (evidence.n_blocks, 128))
        )[:, growing.pixels]
        std = 1.0 / np.sqrt((direction**2).sum(axis=0))
        z.append((growing.dn_per_us - 0.1 * np.array(RATES)) / std)
    found = np.concatenate(z)
    assert abs(found.mean()) < 5.0 / np.sqrt(len(found))
    # The variance that a pixel's own samples tell is wide by 8 %, its misfit widens it further.
    assert abs(found.std() - 1.0) < 5.0 / np.sqrt(2 * len(found))


def test_no_pixel_grows_where_none_is_hot_or_some_jump() -> None:
    jumping = RtsPixels(amplitude_dn=8.0, share=0.03, dwell_up_s=0.02, dwell_down_s=0.02)
    for rng, effects in zip(default_rng().spawn(4), ((), (), (jumping,), (jumping,)), strict=True):
        evidence = recorded(plain_model(128), plan(rng, 60), rng, effects)
        assert evidence.growing is None or len(evidence.growing.pixels) == 0
        assert told_shapes(evidence)["hot_pixels"] == ()
