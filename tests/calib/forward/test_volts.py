"""What the electronics do to the signal: couplings, drifts, outliers."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effects.gain_drift import GainDrift
from calib.forward.effects.heavy_tailed_noise import HeavyTailedNoise
from calib.forward.effects.interpixel_capacitance import InterpixelCapacitance
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.offset_drift import OffsetDrift
from calib.forward.effects.offset_temperature import OffsetTemperature
from calib.forward.effects.tap_crosstalk import TapCrosstalk
from calib.forward.effects.tap_gain_drift import TapGainDrift
from tests.calib.forward.plain_sensor import covariance, plain, score

RNG = np.random.default_rng(0)
seeds = pytest.mark.parametrize("seed", [1, 2, 3])


def at(n_lines: int = 1, **given: float) -> Conditions:
    set_up = {"exposure_us": 50.0, "line_period_us": 100.0} | given
    return Conditions.steady(n_lines, **set_up)  # type: ignore[arg-type]


def point(shape: tuple[int, ...], where: tuple[int, ...]) -> NDArray[np.float64]:
    signal = np.zeros((1, *shape))
    signal[(0, *where)] = 1000.0
    return signal


def test_capacitance_shares_a_pixel_with_its_neighbours_and_keeps_the_sum() -> None:
    line = InterpixelCapacitance(column_coupling=0.01)
    assert np.allclose(line.apply(point((5,), (2,)), at(), RNG), [[0, 10, 980, 10, 0]])
    assert np.allclose(line.apply(point((5,), (0,)), at(), RNG), [[990, 10, 0, 0, 0]])
    frame = InterpixelCapacitance(column_coupling=0.01, row_coupling=0.02)
    middle = frame.apply(point((3, 3), (1, 1)), at(), RNG)[0]
    assert np.allclose(middle, [[0, 20, 0], [10, 940, 10], [0, 20, 0]])
    corner = frame.apply(point((3, 3), (0, 2)), at(), RNG)[0]
    assert np.allclose(corner, [[0, 10, 970], [0, 0, 20], [0, 0, 0]])


@seeds
def test_capacitance_correlates_neighbours_by_its_kernel_and_takes_variance(seed: int) -> None:
    a, b, v, n = 0.04, 0.02, 9.0, 3000
    white = np.random.default_rng(seed).normal(100.0, 3.0, (n, 22, 12))
    read = InterpixelCapacitance(column_coupling=a, row_coupling=b).apply(white, at(n), RNG)
    inner = read[:, 1:-1, 1:-1]
    own = 1 - 2 * a - 2 * b
    standard_error = v * np.sqrt(2.0 / inner.size)
    assert score(covariance(inner, inner), v * (own**2 + 2 * a**2 + 2 * b**2), standard_error) < 5
    pairs = {
        "column": (read[:, 2:-2, 1:-2], read[:, 2:-2, 2:-1], 2 * a * own),
        "row": (read[:, 1:-2, 2:-2], read[:, 2:-1, 2:-2], 2 * b * own),
        "diagonal": (read[:, 1:-2, 1:-2], read[:, 2:-1, 2:-1], 2 * a * b),
        "two columns": (read[:, 2:-2, 1:-3], read[:, 2:-2, 3:-1], a**2),
    }
    for name, (one, other, share) in pairs.items():
        found = covariance(one, other)
        assert score(found, v * share, v * np.sqrt(1.0 / one.size)) < 5, name


def test_a_line_sensor_has_no_rows_to_couple() -> None:
    with pytest.raises(InputError, match="row_coupling") as caught:
        plain(InterpixelCapacitance(row_coupling=0.01))
    assert caught.value.code == "area-sensor"


GHOSTS = {
    "odd and even": ("odd_even", False, (8,), (3,), (2,)),
    "halves side by side": ("halves", False, (8,), (1,), (5,)),
    "halves from the ends": ("halves", True, (8,), (1,), (6,)),
    "quarters side by side": ("quarters", False, (16,), (9,), (13,)),
    "quarters from the ends": ("quarters", True, (16,), (9,), (6,)),
    "quadrants side by side": ("quadrants", False, (4, 6), (3, 1), (3, 4)),
    "quadrants from the corners": ("quadrants", True, (4, 6), (3, 1), (3, 4)),
    "uneven halves": ("halves", False, (7,), (5,), (1,)),
}


@pytest.mark.parametrize(
    ("layout", "mirrored", "shape", "seen", "ghost"), GHOSTS.values(), ids=GHOSTS
)
def test_crosstalk_shows_a_ghost_where_the_partner_reads_at_that_time(
    layout: str, mirrored: bool, shape: tuple[int, ...], seen: tuple[int, ...], ghost: tuple[int]
) -> None:
    mixed = TapCrosstalk(fraction=-0.01, tap_layout=layout, mirrored=mirrored)
    wanted = point(shape, seen)
    wanted[(0, *ghost)] = -10.0
    assert np.allclose(mixed.apply(point(shape, seen), at(), RNG), wanted)


EARLIER = {
    "odd and even": ("odd_even", False, "left", 8, 5, 6),
    "odd and even from the right": ("odd_even", False, "right", 8, 5, 2),
    "halves inwards": ("halves", True, "both", 8, 2, 4),
    "quarters": ("quarters", False, "left", 16, 5, 2),
}


@pytest.mark.parametrize(
    ("layout", "mirrored", "readout", "n", "seen", "ghost"), EARLIER.values(), ids=EARLIER
)
def test_crosstalk_may_show_what_the_partner_has_read_just_before(  # noqa: PLR0917
    layout: str, mirrored: bool, readout: str, n: int, seen: int, ghost: int
) -> None:
    mixed = TapCrosstalk(0.01, layout, mirrored, pixels_before=1, readout=readout)
    wanted = point((n,), (seen,))
    wanted[0, ghost] = 10.0
    assert np.allclose(mixed.apply(point((n,), (seen,)), at(), RNG), wanted)


@pytest.mark.parametrize(("layout", "n", "alone"), [("halves", 7, 3), ("odd_even", 5, 4)])
def test_a_column_too_many_has_no_partner(layout: str, n: int, alone: int) -> None:
    signal = point((n,), (alone,))
    assert np.array_equal(TapCrosstalk(tap_layout=layout).apply(signal, at(), RNG), signal)


@seeds
def test_crosstalk_correlates_partners_and_no_other_columns(seed: int) -> None:
    x, v, n = 0.03, 4.0, 4000
    white = np.random.default_rng(seed).normal(100.0, 2.0, (n, 100))
    read = TapCrosstalk(fraction=x).apply(white, at(n), RNG)
    even, odd = read[:, ::2], read[:, 1::2]
    assert score(even.mean(), 100.0 * (1 + x), 2.0 / np.sqrt(even.size)) < 5
    assert score(covariance(even, odd), 2 * x * v, v / np.sqrt(even.size)) < 5
    assert score(covariance(odd[:, :-1], even[:, 1:]), 0.0, v / np.sqrt(even.size)) < 5
    assert score(covariance(even, even), v * (1 + x**2), v * np.sqrt(2 / even.size)) < 5


def test_taps_drift_apart_with_wall_time_in_proportion_to_the_signal() -> None:
    drift = TapGainDrift(amplitude=(0.1, -0.2), time_constant_s=5.0, tap_layout="halves")
    start, later = (
        drift.apply(np.array([[10.0, 20.0, 30.0, 40.0]]), at(started_s=t), RNG)[0] for t in (0, 5)
    )
    assert start.tolist() == [10.0, 20.0, 30.0, 40.0]
    share = 1 - np.exp(-1)
    assert np.allclose(later, start * (1 + share * np.array([0.1, 0.1, -0.2, -0.2])))


def test_tap_effects_have_to_fit_the_camera() -> None:
    more = 'taps = 2\ntap_layout = "halves"'
    for effect in (TapCrosstalk(), TapGainDrift()):
        with pytest.raises(InputError, match="tap_layout") as caught:
            plain(effect, more=more)
        assert caught.value.code == "tap-layout-mismatch"
        assert plain(replace(effect, tap_layout="halves"), more=more).effect(effect.name)
    with pytest.raises(InputError, match="has 3 values") as caught:
        plain(TapGainDrift(amplitude=(0.0, 0.1, 0.2), tap_layout="halves"), more=more)
    assert caught.value.code == "wrong-length"


@seeds
def test_a_drifting_gain_scales_shot_noise_over_signal_where_a_drifting_lamp_does_not(
    seed: int,
) -> None:
    a, n, electrons, offset = 0.4, 400, 500.0, 100.0
    late = replace(at(n, started_s=30.0), lamps=(1.0,))
    grown = 1 + a * (1 - np.exp(-30.0 / 10.0))
    rng = np.random.default_rng(seed)
    for effect, gain, light in (
        (GainDrift(amplitude=a, time_constant_s=10.0), grown, 1.0),
        (LampDrift(amplitude=a, time_constant_s=10.0), 1.0, grown),
    ):
        dn = plain(effect, columns=1000).draw(late, rng).dn - offset
        m = electrons * light
        # The lines span 40 ms of a drift over 10 s: 4e-3 x 0.05 x 0.4 of the signal, far below.
        assert score(dn.mean(), gain * m, gain * np.sqrt(m / dn.size) + 1e-4 * gain * m) < 5
        rounding = 1 / 12 if gain != 1.0 else 0.0
        ratio = (covariance(dn, dn) - rounding) / dn.mean()
        assert score(ratio, gain, gain * np.sqrt(2.5 / dn.size)) < 5


def test_the_offset_drifts_with_time_and_temperature_whatever_the_signal() -> None:
    signal = np.array([[0.0, 500.0]])
    drifted = OffsetDrift(amplitude_dn=-3.0, time_constant_s=20.0)
    assert np.array_equal(drifted.apply(signal, at(started_s=0.0), RNG), signal)
    later = drifted.apply(signal, at(started_s=40.0), RNG)
    assert np.allclose(later - signal, -3.0 * (1 - np.exp(-2.0)))
    warm = OffsetTemperature(dn_per_k=0.5, reference_c=20.0)
    assert np.allclose(warm.apply(signal, at(sensor_temperature_c=31.0), RNG) - signal, 5.5)


@seeds
def test_outliers_add_their_variance_and_their_fourth_cumulant(seed: int) -> None:
    share, std, n = 0.02, 40.0, 2_000_000
    noise = HeavyTailedNoise(share=share, std_e=std)
    x = noise.apply(np.full((100, n // 100), 7.0), at(100), np.random.default_rng(seed)).ravel() - 7
    fourth, eighth = 3 * share * std**4, 105 * share * std**8
    variance = share * std**2
    assert score(np.mean(x), 0.0, np.sqrt(variance / n)) < 5
    assert score(np.mean(x**2), variance, np.sqrt((fourth - variance**2) / n)) < 5
    cumulant = np.mean(x**4) - 3 * np.mean(x**2) ** 2
    assert score(cumulant, 3 * share * (1 - share) * std**4, np.sqrt(eighth / n)) < 5
    assert score(np.mean(x != 0), share, np.sqrt(share * (1 - share) / n)) < 5
