"""Mechanisms of light, exposure, heat and drift: shifts of the mean from their own formulas."""

import numpy as np
import pytest

from tests.concealed.bench import EXPOSURE_US, drawn, level_sensor, scan_of
from tests.concealed.generator import courses
from tests.concealed.generator.mechanism import Mechanism
from tests.concealed.generator.mechanisms.drifts import TapGainDrift
from tests.concealed.generator.mechanisms.exposure import ExposureJitter, ExposureOffset
from tests.concealed.generator.mechanisms.source import LampDrift, LampFlicker, StrayLight
from tests.concealed.generator.mechanisms.thermal import DarkCurrent, DarkCurrentTemperature

RNG = np.random.default_rng


def acted(one: Mechanism, signal: np.ndarray, n: int = 100, **scan: object) -> np.ndarray:
    memory = {"exposure_us": np.full((n, 1, 1), EXPOSURE_US)}
    at = scan_of(level_sensor(), n, **scan)  # type: ignore[arg-type]
    return np.asarray(one.act(signal, at, memory, RNG(1)))


@pytest.mark.parametrize("shape", [*courses.KNOWN, *courses.FOREIGN])
def test_courses_begin_at_nothing_and_reach_about_one(shape: str) -> None:
    share = np.linspace(0.0, 1.0, 1001)
    course = courses.course(shape, 0.4, share)
    assert course[0] == 0.0
    assert np.abs(course).max() == pytest.approx(1.0, abs=1e-3)


def test_a_linear_drift_has_its_strength_at_the_end() -> None:
    drift = LampDrift(0.02, "linear", 1.0, 0.5)
    lit = acted(drift, np.ones((100, 1, 1)), started_s=9.0)
    np.testing.assert_allclose(lit[:, 0, 0], 1 + 0.02 * (0.9 + np.arange(100) * 1.2e-4))


def test_flicker_is_the_mean_of_the_sine_over_the_exposure() -> None:
    flicker = LampFlicker(0.1, "sine", 100.0, 0.7)
    lit = acted(flicker, np.ones((100, 1, 1)))
    opened = np.arange(100)[:, np.newaxis] * 1.2e-3
    inside = opened + (np.arange(4000) + 0.5) / 4000 * EXPOSURE_US * 1e-6
    expected = 1 + 0.1 * np.sin(2 * np.pi * 100.0 * inside + 0.7).mean(axis=1)
    np.testing.assert_allclose(lit[:, 0, 0], expected, atol=1e-8)


def test_stray_light_stays_out_of_capped_darks() -> None:
    stray = StrayLight(0.01, "uniform")
    none = np.zeros((100, 1, 1))
    np.testing.assert_array_equal(acted(stray, none, kind="dark"), none)
    np.testing.assert_allclose(acted(stray, none), 0.01)


def test_an_exposure_offset_is_the_same_time_everywhere() -> None:
    offset = ExposureOffset(3.0, "plain", -1.0)
    np.testing.assert_allclose(acted(offset, np.array([10.0, 1000.0])), [7.0, 997.0])


@pytest.mark.parametrize("shape", ["gaussian", "two_valued"])
def test_jitter_has_its_standard_deviation(shape: str) -> None:
    n = 20_000
    exposures = acted(ExposureJitter(0.01, shape), np.full((n, 1, 1), EXPOSURE_US), n)
    assert abs(exposures.std() / EXPOSURE_US - 0.01) < 4 * 0.01 / np.sqrt(2 * n)
    assert abs(exposures.mean() / EXPOSURE_US - 1) < 4 * 0.01 / np.sqrt(n)


def test_dark_current_is_there_with_the_cap_on_and_grows_with_the_exposure() -> None:
    dark = drawn(DarkCurrent, 0.05, "gaussian", level_sensor())
    electrons = acted(dark, np.zeros((100, 1, 64)), kind="dark")
    # 64 rates with a scatter of a tenth.
    assert abs(electrons.mean() / (0.05 * EXPOSURE_US) - 1) < 4 * 0.1 / np.sqrt(64)


def test_silicon_at_room_temperature_doubles_its_dark_current_every_five_to_nine_kelvin() -> None:
    for shape, low, high in (("doubling", 5.5, 8.5), ("arrhenius", 4.5, 6.0), ("surface", 8.0, 11)):
        dark = drawn(DarkCurrentTemperature, 0.05, shape, level_sensor())
        cold, warm = (
            acted(dark, np.zeros((9, 1, 64)), 9, kind="dark", warmth_k=t).mean() for t in (0.0, 7.0)
        )
        assert low <= 7.0 / np.log2(warm / cold) <= high, shape


def test_taps_part_without_moving_their_mean() -> None:
    sensor = level_sensor(layout="odd_even")
    drift = TapGainDrift(0.01, "linear", 1.0, 0.5, 1)
    at = scan_of(sensor, 10, started_s=9.988)
    dn = np.asarray(drift.act(np.ones((10, 1, 64)), at, {}, RNG(0)))[-1, 0]
    assert dn[1::2].mean() - dn[0::2].mean() == pytest.approx(0.01, rel=2e-3)
    assert dn.mean() == pytest.approx(1.0, abs=1e-12)
