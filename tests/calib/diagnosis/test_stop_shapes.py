import numpy as np
import pytest
from numpy.random import default_rng

from calib.diagnosis.diagnose import examine
from calib.diagnosis.shapes.dark_codes import DarkCodes
from calib.diagnosis.shapes.gathered_darks import dark_codes
from calib.diagnosis.shapes.stop_shapes import stop_shapes
from calib.forward.effect import Effect
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.stuck_bit import StuckBit
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

LAYOUT = "odd_even"
TWO_TAPS = plain_model(96, taps=2, layout=LAYOUT)


@pytest.mark.parametrize(
    "stop",
    [
        BlackClip(63),
        BlackClip(64, 0.5),
        BlackClip(63, only_tap=1, tap_layout=LAYOUT),
        BlackClip(64, 0.5, only_tap=0, tap_layout=LAYOUT),
    ],
    ids=["hard", "soft", "of a tap", "soft of a tap"],
)
def test_darks_tell_where_codes_stop_and_of_which_tap(stop: BlackClip) -> None:
    rng = default_rng()
    evidence = recorded(TWO_TAPS, plan(rng, 60, twice=0), rng, (stop,))
    # Some 17,000 reads in the dark, of which a sixth and more lie below the level.
    likeliest = max(stop_shapes(evidence), key=lambda shape: shape.credit)
    assert likeliest.template == stop


def test_a_hot_pixel_takes_no_table_of_its_own() -> None:
    rng, stop = default_rng(), BlackClip(63, only_tap=1, tap_layout=LAYOUT)
    hot = HotPixels(pixels=(7,), rates_e_per_us=(20.0,))
    evidence = recorded(TWO_TAPS, plan(rng, 60, twice=0), rng, (hot, stop))
    for each in dark_codes(evidence):
        # It gives up to 2,000 DN in the dark, where all others are within 5 DN of each other.
        assert each is not None
        assert len(each.seen) < 24.0 * each.std + 3.0
        assert each.seen.sum() == each.weight.sum() == 3 * 60 * 48
    assert max(stop_shapes(evidence), key=lambda shape: shape.credit).template == stop


@pytest.mark.parametrize(
    "beside", [(), (DarkCurrent(0.02),), (StuckBit(0.1, 1, 0),)], ids=["plain", "skewed", "stuck"]
)
def test_darks_without_a_stop_tell_none(beside: tuple[Effect, ...]) -> None:
    rng = default_rng()
    evidence = recorded(TWO_TAPS, plan(rng, 60, twice=0), rng, beside)
    # A deviance of 20 beyond chance, of some hundred trials, once in a thousand recordings.
    assert max(shape.credit for shape in stop_shapes(evidence)) < 20.0


def test_skewness_of_few_electrons_is_no_stop() -> None:
    rng, n = default_rng(), 200_000
    electrons = rng.poisson(10.0, n) + rng.normal(0.0, 5.0, n)
    codes = np.rint(40.0 + 0.5 * (electrons - electrons.mean()))
    seen = np.bincount(codes.astype(np.intp), minlength=80).astype(np.float64)
    darks = DarkCodes(seen, 0, np.array([40.0, 40.0]), np.array([n / 2, n / 2]), codes.std())
    plain, expected = darks.deviance(None)
    stopped = min(darks.deviance(BlackClip(level, 0.5).faulty)[0] for level in range(28, 44))
    # Their skewness is 10 / 35^1.5 = 0.048, nine of its standard errors of sqrt(6 / n).
    assert plain - stopped < 20.0
    enough = expected > 10.0
    misfit = ((seen - expected)[enough] ** 2 / expected[enough]).sum()
    assert misfit < enough.sum() + 6.0 * np.sqrt(2.0 * enough.sum())


def test_a_soft_stop_of_one_tap_is_named() -> None:
    rng = default_rng()
    stop = BlackClip(64, 0.5, only_tap=0, tap_layout=LAYOUT)
    diagnosis = examine(recorded(TWO_TAPS, plan(rng, 100, twice=0), rng, (stop,))).diagnosis
    # One recording of fifty may have another name beside it by chance.
    assert diagnosis.findings[0].effect == stop
    assert diagnosis.verdict != "unexplained"


def test_line_noise_beside_a_strong_stop_is_told_at_its_own_strength() -> None:
    rng, true = default_rng(), 0.3
    effects = (LineNoise(true), BlackClip(64))
    found = examine(recorded(plain_model(96), plan(rng, 100, twice=0), rng, effects)).diagnosis
    # Half of the darks' samples lie below the level, and a quarter of what lines share is left.
    assert [finding.effect.name for finding in found.findings] == ["black_clip", "line_noise"]
    strength = found.findings[1].parameters["std_dn"]
    assert abs(strength.value - true) < 5.0 * strength.std
    assert strength.std < 0.15 * true
