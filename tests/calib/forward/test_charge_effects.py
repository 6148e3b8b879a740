"""Hot pixels, glow and the knee obey formulas and moments that are derived here anew."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from calib.errors import InputError
from calib.forward.effects.amplifier_glow import AmplifierGlow
from calib.forward.effects.hot_pixels import HotPixels
from calib.forward.effects.saturation_knee import SaturationKnee
from calib.forward.model import Model
from tests.calib.forward.small_sensors import SENSORS, at, sensors

RNG = np.random.default_rng(0)
SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])


@pytest.mark.parametrize("sample", [(40_000,), (200, 200)], ids=["line", "frame"])
@SEEDS
def test_hot_pixels_are_few_and_their_rates_exponential(sample: tuple[int, ...], seed: int) -> None:
    share, mean, n = 0.02, 3.0, 40_000
    rates = HotPixels(share=share, electrons_per_us=mean, seed=seed).rates(sample)
    assert rates.shape == sample
    hot = rates[rates > 0]
    assert abs(hot.size - n * share) < 5 * np.sqrt(n * share * (1 - share))
    assert abs(hot.mean() / mean - 1) < 5 / np.sqrt(hot.size)
    assert stats.kstest(hot, "expon", args=(0, mean)).pvalue > 1e-6


@sensors
def test_hot_pixels_grow_with_exposure_in_the_dark(model: Model) -> None:
    given = HotPixels(share=0.5, pixels=(3, 40), rates_e_per_us=(2.0, 5.0))
    hot = model.with_effect(given)
    for exposure_us in (10.0, 80.0):
        dark = at(2000, capped=True, exposure_us=exposure_us)
        electrons = hot.draw(dark, np.random.default_rng(4)).electrons.reshape(2000, -1)[0]
        wanted = np.zeros_like(electrons)
        wanted[[3, 40]] = np.array([2.0, 5.0]) * exposure_us
        assert np.allclose(electrons, wanted, rtol=1e-12)
        dn = hot.draw(dark, np.random.default_rng(4)).dn.reshape(2000, -1)
        gain = model.truth().system_gain_dn_per_e
        offset = model.truth().dark_offset_dn.ravel()
        variance = gain**2 * (wanted + 144.0) + 1 / 12
        score = (dn.mean(axis=0) - offset - gain * wanted) / np.sqrt(variance / 2000)
        assert np.abs(score[[3, 40]]).max() < 5


BAD_PIXELS: dict[str, tuple[dict[str, Any], str]] = {
    "beyond the sensor": ({"pixels": (168,), "rates_e_per_us": (1.0,)}, "bad-pixels"),
    "no rates": ({"pixels": (1, 2)}, "bad-pixels"),
    "a rate too few": ({"pixels": (1, 2), "rates_e_per_us": (1.0,)}, "wrong-length"),
}


@pytest.mark.parametrize(("given", "code"), BAD_PIXELS.values(), ids=BAD_PIXELS)
def test_hot_pixels_that_do_not_fit_are_refused(given: dict[str, Any], code: str) -> None:
    with pytest.raises(InputError, match="hot_pixels") as caught:
        SENSORS["frame"].with_effect(HotPixels(**given))
    assert caught.value.code == code


def test_glow_falls_to_1_over_e_over_its_decay_from_the_end_of_a_line() -> None:
    left = AmplifierGlow(electrons_per_us=2.0, decay_columns=25.0)
    assert np.allclose(left.rates(101)[[0, 25, 50, 100]], 2.0 * np.exp([0.0, -1.0, -2.0, -4.0]))
    right = AmplifierGlow(electrons_per_us=2.0, decay_columns=25.0, end="right")
    assert np.array_equal(right.rates((101,)), left.rates(101)[::-1])


@pytest.mark.parametrize("end", ["left", "right"])
@pytest.mark.parametrize("corner", ["top", "bottom"])
def test_glow_is_round_about_its_corner_of_a_frame(end: str, corner: str) -> None:
    glow = AmplifierGlow(electrons_per_us=1.0, decay_columns=5.0, end=end, corner=corner)
    rates = glow.rates((31, 41))
    row, column = (0 if corner == "top" else 30), (0 if end == "left" else 40)
    for down, along in ((0, 0), (3, 4), (5, 0), (0, 5), (30, 40)):
        at_pixel = rates[abs(row - down), abs(column - along)]
        assert at_pixel == pytest.approx(np.exp(-np.sqrt(down**2 + along**2) / 5.0), rel=1e-12)


@sensors
def test_glow_grows_with_exposure_under_the_cap(model: Model) -> None:
    glow = AmplifierGlow(electrons_per_us=3.0, decay_columns=10.0)
    dark = at(2, capped=True, exposure_us=70.0)
    electrons = model.with_effect(glow).draw(dark, RNG).electrons[0]
    assert electrons.flat[0] == pytest.approx(210.0, rel=1e-12)
    assert electrons[..., 10].flat[0] == pytest.approx(210.0 / np.e, rel=1e-12)


@sensors
def test_the_knee_keeps_the_share_that_the_room_left_allows(model: Model) -> None:
    sample = model.truth().vignette.shape
    knee = SaturationKnee(threshold_e=1000.0, room_e=500.0, relative_spread=0.0)
    arrived = np.linspace(0.0, 3000.0, 30_001)
    kept, q = np.zeros_like(arrived), 0.0
    for k, step in enumerate(np.diff(arrived), start=1):
        middle = q + step / 2 * (1 - max(q - 1000.0, 0.0) / 500.0)
        q += step * (1 - max(middle - 1000.0, 0.0) / 500.0)
        kept[k] = q
    for charge in (0.0, 999.0, 1000.0, 1200.0, 2000.0, 3000.0):
        got = knee.apply(np.full((1, *sample), charge), at(1), RNG)
        assert np.allclose(got, np.interp(charge, arrived, kept), rtol=1e-6)
        if charge <= 1000.0:
            assert np.all(got == charge)


@SEEDS
def test_thresholds_spread_among_pixels_and_belong_to_them(seed: int) -> None:
    n = 20_000
    knee = SaturationKnee(threshold_e=1000.0, relative_spread=0.05, seed=seed)
    drawn = knee.thresholds((100, 200))
    assert drawn.mean() == pytest.approx(1000.0, abs=5 * 50.0 / np.sqrt(n))
    assert drawn.std() == pytest.approx(50.0, abs=5 * 50.0 / np.sqrt(2 * n))
    other = SaturationKnee(threshold_e=1000.0, relative_spread=0.05, seed=seed + 10)
    assert abs(np.corrcoef(drawn.ravel(), other.thresholds((100, 200)).ravel())[0, 1]) < 5 / n**0.5


@SEEDS
def test_the_knee_bends_the_variance_by_its_slope_squared(seed: int) -> None:
    mean, n = 25_000.0, 60_000
    knee = SaturationKnee(threshold_e=20_000.0, room_e=10_000.0, relative_spread=0.0)
    charge = np.random.default_rng(seed).poisson(mean, (n, 1)).astype(np.float64)
    kept = knee.apply(charge, at(n), RNG)
    slope = np.exp(-0.5)
    second_order = mean / 10_000.0**2  # (curvature / slope)^2 x variance, of the variance
    assert abs(kept.var() / (slope**2 * mean) - 1) < 5 * np.sqrt(2 / n) + second_order
