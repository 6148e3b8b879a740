import pytest
from numpy.random import default_rng

from calib.diagnosis.diagnose import examine
from calib.forward.effect import Effect
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.cosmic_rays import CosmicRays
from calib.forward.effects.duplicated_lines import DuplicatedLines
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.offset import Offset
from calib.forward.effects.read_noise import ReadNoise
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

HOT = HotPixels(pixels=(7, 30, 80), rates_e_per_us=(0.3, 0.4, 0.6))


@pytest.mark.parametrize(
    "effect",
    [HOT, CosmicRays(per_pixel_s=0.5, electrons=1000.0), BlackClip(62), DuplicatedLines(0.01)],
    ids=lambda effect: effect.name,
)
def test_what_lives_in_single_samples_pixels_and_codes_is_named_alone(effect: Effect) -> None:
    rng = default_rng()
    evidence = recorded(plain_model(96), plan(rng, 100, twice=0), rng, (effect,))
    diagnosis = examine(evidence).diagnosis
    assert [finding.effect.name for finding in diagnosis.findings][:1] == [effect.name]
    # A stop has no strength to fit: of a strong one, something may be left in the histogram.
    assert diagnosis.verdict != "unexplained" or effect.name == "black_clip"


@pytest.mark.parametrize("stop", [(), (BlackClip(19),)], ids=["free", "stopped"])
def test_a_stop_shows_in_what_is_missing_of_darks_with_half_a_dn_of_noise(
    stop: tuple[Effect, ...],
) -> None:
    rng = default_rng()
    model = plain_model(96, bits=8).with_effect(ReadNoise(10.0)).with_effect(Offset(20.0, 0.2))
    evidence = recorded(model, plan(rng, 300, twice=0), rng, stop)
    counts = evidence.code_counts
    below = counts.whitened(counts.residual())[-2]
    # Of 86,400 reads in the dark, of 0.5 and 0.2 DN, 0.27 % or 235 would lie below 18.5 DN; a fit
    # to what is left expects half of them, 117 / sqrt(30 + 117) = 9.6 standard deviations.
    assert below < -5.0 if stop else abs(below) < 5.0
