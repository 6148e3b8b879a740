"""Effects of the converter and its codes obey histograms and moments that are derived here anew."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from calib.errors import InputError
from calib.forward.effects.adc import Adc
from calib.forward.effects.adc_dnl import AdcDnl
from calib.forward.effects.adc_inl import AdcInl
from calib.forward.effects.black_clip import BlackClip
from calib.forward.effects.stuck_bit import StuckBit
from calib.forward.model import Model
from tests.calib.forward.small_sensors import DEMO, at, sensors

RNG = np.random.default_rng(0)
SEEDS = pytest.mark.parametrize("seed", [1, 2, 3])
EIGHT = Model.preset("agcam-nir")


def codes_of(dnl: AdcDnl, dn: NDArray[np.float64]) -> NDArray[np.float64]:
    lines = at(len(dn))
    return Adc(bit_depth=dnl.bit_depth).apply(dnl.apply(dn, lines, RNG), lines, RNG)


@SEEDS
@pytest.mark.parametrize("shape", [(4000, 50), (4000, 5, 10)], ids=["line", "frame"])
def test_the_mean_code_follows_the_sines_of_the_inl(seed: int, shape: tuple[int, ...]) -> None:
    inl = AdcInl(bow_dn=3.0, s_dn=-2.0, w_dn=1.0, bit_depth=10)
    level = np.linspace(30.0, 990.0, 50).reshape(shape[1:])
    noise = np.random.default_rng(seed).standard_normal(shape)
    lines = at(shape[0])
    codes = Adc(bit_depth=10).apply(inl.apply(level + 2.0 * noise, lines, RNG), lines, RNG)
    part = level / 1023.0
    wanted = level + 3.0 * np.sin(np.pi * part) - 2.0 * np.sin(2 * np.pi * part)
    wanted += np.sin(3 * np.pi * part)
    # The noise sees the bend: half of its variance times the second derivative, below 1e-4 DN.
    score = (codes.mean(axis=0) - wanted) / np.sqrt((4.0 * 1.03 + 1 / 12) / shape[0])
    assert np.abs(score).max() < 5


def test_the_inl_vanishes_at_both_ends_and_beyond() -> None:
    ends = np.array([[-50.0, 0.0, 4095.0, 5000.0]])
    bent = AdcInl(bow_dn=5.0, s_dn=5.0, w_dn=5.0).apply(ends, at(1), RNG)
    assert np.allclose(bent, ends, rtol=0, atol=1e-11)


@SEEDS
def test_codes_come_up_in_proportion_to_their_widths(seed: int) -> None:
    widths = np.ones(256)
    widths[[20, 21]] = (0.3, 1.7)
    widths[[40, 41, 42]] = (0.0, 0.0, 3.0)
    widths[[60, 61]] = (2.0, 0.0)
    dnl = AdcDnl(widths_dn=tuple(widths), bit_depth=8)
    dn = np.random.default_rng(seed).uniform(9.5, 79.5, (1000, 400))
    counts = np.bincount(codes_of(dnl, dn).astype(int).ravel(), minlength=256)
    assert counts[[40, 41, 61]].tolist() == [0, 0, 0]
    assert counts[:10].sum() == counts[80:].sum() == 0
    present = [k for k in range(10, 80) if widths[k] > 0]
    wanted = widths[present] / widths[present].sum() * dn.size
    assert stats.chisquare(counts[present], wanted).pvalue > 1e-6


def test_widths_of_the_first_codes_are_repeated_by_all_others() -> None:
    few = AdcDnl(widths_dn=(1.5, 0.7, 0.8, 1.2), bit_depth=8)
    every = AdcDnl(widths_dn=few.widths_dn * 64, bit_depth=8)
    assert np.array_equal(few.widths(), every.widths())
    assert few.widths()[:4].tolist() == pytest.approx(np.array(few.widths_dn) / 1.05, abs=1e-12)
    assert few in EIGHT.with_effect(few).effects


@SEEDS
def test_drawn_widths_have_their_scatter_and_a_mean_of_one(seed: int) -> None:
    n = 1 << 14
    widths = AdcDnl(width_std_dn=0.2, seed=seed, bit_depth=14).widths()
    assert widths.mean() == pytest.approx(1.0, abs=1e-12)
    assert widths.min() >= 0
    # Neighbouring widths share a transition: correlation -1/2, so n counts for 2/3 of it.
    assert widths.std() == pytest.approx(0.2, abs=5 * 0.2 * np.sqrt(1.5 / (2 * n)))
    off = widths - 1
    assert np.mean(off[1:] * off[:-1]) / np.mean(off**2) == pytest.approx(-0.5, abs=5 / np.sqrt(n))
    other = AdcDnl(width_std_dn=0.2, seed=seed + 10, bit_depth=14).widths()
    assert abs(np.corrcoef(widths, other)[0, 1]) < 5 * np.sqrt(1.5 / n)


@SEEDS
def test_dnl_leaves_the_means_right_over_many_codes(seed: int) -> None:
    dnl = AdcDnl(width_std_dn=0.4, seed=seed)
    dn = np.random.default_rng(seed).uniform(99.5, 3099.5, (2000, 100))
    off = codes_of(dnl, dn) - dn
    # Each code's transition is off by 0.4 / sqrt(2), its interval's rounding by 1 / sqrt(12).
    error = np.sqrt(0.08 / 3000 + (1 / 12 + 0.08) / dn.size)
    assert abs(off.mean()) < 5 * error


@SEEDS
def test_missing_codes_never_come_and_the_code_below_takes_their_place(seed: int) -> None:
    dnl = AdcDnl(width_std_dn=0.0, missing_share=0.05, seed=seed, bit_depth=12)
    widths = dnl.widths()
    missing = np.flatnonzero(widths < 0.5)
    assert abs(missing.size - 4094 * 0.05) < 5 * np.sqrt(4094 * 0.05 * 0.95)
    assert set(np.unique(widths)) <= set(np.arange(10.0))
    seen = codes_of(dnl, np.arange(4096.0)[np.newaxis])[0]
    assert not np.isin(missing, seen).any()
    kept = np.setdiff1d(np.arange(4096), missing)
    assert np.array_equal(seen, kept[np.searchsorted(kept, np.arange(4096), side="right") - 1])


def test_codes_ascend_with_dn_and_both_ends_clip_as_ever() -> None:
    dnl = AdcDnl(width_std_dn=0.9, bit_depth=8)
    dn = np.linspace(-20.0, 280.0, 30_001)[np.newaxis]
    codes = codes_of(dnl, dn)[0]
    assert np.all(np.diff(codes) >= 0)
    assert codes[0] == 0
    assert codes[-1] == 255
    assert np.all(codes[dn[0] >= 255.5] == 255)


@sensors
@pytest.mark.parametrize("value", [0, 1])
def test_a_bit_that_sticks_at_times_does_so_by_chance_and_changes_no_other(
    model: Model, value: int
) -> None:
    for seed in (1, 2, 3):
        plain = model.draw(at(300), np.random.default_rng(seed)).dn.astype(int)
        sticking = model.with_effect(StuckBit(probability=0.3, bit=4, value=value))
        dn = sticking.draw(at(300), np.random.default_rng(seed)).dn.astype(int)
        assert np.all(((dn ^ plain) & ~16) == 0)
        exposed = ((plain >> 4) & 1) != value
        changed = dn != plain
        assert not changed[~exposed].any()
        n = int(exposed.sum())
        assert abs(changed.sum() - 0.3 * n) < 5 * np.sqrt(n * 0.3 * 0.7)


@sensors
def test_a_bit_that_always_sticks_leaves_half_of_the_codes_out(model: Model) -> None:
    stuck = model.with_effect(StuckBit(probability=1.0, bit=2, value=1))
    dn = stuck.draw(at(100), np.random.default_rng(1)).dn
    assert np.all((dn >> 2) & 1 == 1)
    assert dn.dtype == np.uint16


@sensors
def test_codes_stop_at_the_black_level_and_change_nowhere_else(model: Model) -> None:
    dark = at(200, capped=True)
    plain = model.draw(dark, np.random.default_rng(1)).dn
    dn = model.with_effect(BlackClip(level_dn=64)).draw(dark, np.random.default_rng(1)).dn
    assert np.array_equal(dn, np.where(plain < 64, 64, plain))
    # Gaussian darks about DN0 with 12 e- of read noise, rounded: what of them lies below.
    k = model.truth().system_gain_dn_per_e
    below = stats.norm.cdf((64.5 - model.truth().dark_offset_dn) / (k * 12.0))
    wanted, variance = 200 * below.sum(), 200 * (below * (1 - below)).sum()
    assert abs((dn == 64).sum() - wanted) < 5 * np.sqrt(variance)


def test_a_clip_raises_the_darks_mean_and_lowers_its_variance_as_a_cut_normal_does() -> None:
    z = np.random.default_rng(3).standard_normal((4000, 100))
    dark = np.rint(60.0 + 4.0 * z)
    cut = BlackClip(level_dn=60).apply(dark, at(4000), RNG)
    codes = np.arange(20, 101)
    share = np.diff(stats.norm.cdf(np.arange(19.5, 101.0), 60.0, 4.0))
    mean = float(np.sum(share * np.maximum(codes, 60)))
    variance = float(np.sum(share * (np.maximum(codes, 60) - mean) ** 2))
    fourth = float(np.sum(share * (np.maximum(codes, 60) - mean) ** 4))
    assert abs(cut.mean() - mean) < 5 * np.sqrt(variance / z.size)
    assert abs(cut.var() - variance) < 5 * np.sqrt((fourth - variance**2) / z.size)


def test_a_soft_stop_keeps_a_part_of_the_distance_in_whole_codes() -> None:
    codes = np.arange(50.0, 64.0)[None]
    soft = BlackClip(level_dn=60, keeps=0.5).apply(codes, at(1), RNG)
    assert soft[0].tolist() == [55, 56, 56, 57, 57, 58, 58, 59, 59, 60, 60, 61, 62, 63]
    assert np.array_equal(BlackClip(level_dn=60, keeps=1.0).apply(codes, at(1), RNG), codes)


@pytest.mark.parametrize(
    "fault",
    [
        BlackClip(level_dn=60, only_tap=1, tap_layout="halves"),
        StuckBit(1.0, 2, 1, only_tap=1, tap_layout="halves"),
    ],
    ids=lambda fault: fault.name,
)
def test_a_fault_of_one_tap_leaves_the_other_taps_codes(fault: BlackClip | StuckBit) -> None:
    codes = np.full((3, 8), 56.0)
    found = fault.apply(codes, at(3), RNG)
    assert np.array_equal(found[:, :4], codes[:, :4])
    assert np.array_equal(found[:, 4:], np.full((3, 4), 60.0))


REFUSED: dict[str, tuple[Model, Any, str]] = {
    "INL of another depth": (EIGHT, AdcInl(), "bit-depth-mismatch"),
    "DNL of another depth": (EIGHT, AdcDnl(), "bit-depth-mismatch"),
    "a width too few": (EIGHT, AdcDnl(widths_dn=(1.0,) * 255, bit_depth=8), "wrong-length"),
    "widths that end amid the codes": (
        EIGHT,
        AdcDnl(widths_dn=(1.0, 1.1, 0.9), bit_depth=8),
        "wrong-length",
    ),
    "no such bit": (EIGHT, StuckBit(bit=8), "no-such-code"),
    "no such level": (DEMO, BlackClip(level_dn=4095), "no-such-code"),
    "a tap of another layout": (
        EIGHT,
        BlackClip(only_tap=0, tap_layout="quarters"),
        "tap-layout-mismatch",
    ),
    "no such tap": (
        EIGHT,
        StuckBit(only_tap=3, tap_layout=EIGHT.camera.tap_layout),
        "no-such-tap",
    ),
    "widths of nothing": (EIGHT, AdcDnl(widths_dn=(0.0,) * 256, bit_depth=8), "no-such-code"),
}


@pytest.mark.parametrize(("model", "effect", "code"), REFUSED.values(), ids=REFUSED)
def test_codes_that_the_camera_lacks_are_refused(model: Model, effect: Any, code: str) -> None:
    with pytest.raises(InputError, match=f"effect {effect.name}") as caught:
        model.with_effect(effect)
    assert caught.value.code == code
