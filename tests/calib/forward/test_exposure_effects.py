"""Exposure and reciprocity obey formulas that are derived here anew."""

from dataclasses import replace

import numpy as np
import pytest

from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.exposure_jitter import ExposureJitter
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.effects.reciprocity_failure import ReciprocityFailure
from calib.forward.model import Model
from tests.calib.forward.small_sensors import (
    DEMO,
    LAMPS,
    at,
    light_dn,
    per_radiance_us,
    sensors,
)

RNG = np.random.default_rng(0)


@sensors
@pytest.mark.parametrize("offset_us", [2.5, -4.0])
def test_an_exposure_offset_lengthens_light_and_dark_charge_alike(
    model: Model, offset_us: float
) -> None:
    dark = DarkCurrent(electrons_per_us=3.0, dsnu_std_e_per_us=0.0)
    shifted = model.with_effect(dark).with_effect(ExposureOffset(offset_us=offset_us))
    dark_dn = 3.0 * model.truth().system_gain_dn_per_e
    for exposure_us in (10.0, 50.0):
        for lamps in ((), (1.0, 1.0)):
            lit = at(3, exposure_us=exposure_us, lamps=lamps)
            per_us = sum(LAMPS[: len(lamps)]) * per_radiance_us(model) + dark_dn
            wanted = per_us * (exposure_us + offset_us)
            assert np.allclose(light_dn(shifted, lit), wanted, rtol=1e-12)
            drawn = shifted.draw(lit, np.random.default_rng(3))
            k = model.truth().system_gain_dn_per_e
            assert np.allclose(drawn.electrons * k, wanted, rtol=1e-12)


def test_an_exposure_that_is_cut_by_more_than_its_length_is_none() -> None:
    cut = DEMO.with_effect(ExposureOffset(offset_us=-60.0))
    assert np.array_equal(light_dn(cut, at(1)), light_dn(DEMO, at(1, capped=True)))


@sensors
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_jitter_moves_all_pixels_together_in_proportion_to_the_signal_and_white(
    model: Model, seed: int
) -> None:
    n, std = 1500, 0.02
    jittered = model.with_effect(ExposureJitter(relative_std=std))
    lines = at(n)
    dn = jittered.draw(lines, np.random.default_rng(seed)).dn.reshape(n, -1)
    plain = light_dn(model, at(1))[0].ravel()
    k = model.truth().system_gain_dn_per_e
    own = (np.mean(k * plain + (k * 12.0) ** 2) + 1 / 12) / dn.shape[1]
    means = dn.mean(axis=1)
    wanted = (std * plain.mean()) ** 2 + own
    assert abs(means.var(ddof=1) / wanted - 1) < 5 * np.sqrt(2 / n)
    off = means - means.mean()
    assert abs(np.mean(off[1:] * off[:-1]) / means.var()) < 5 / np.sqrt(n)
    left, right = (part.mean(axis=1) for part in np.array_split(dn, 2, axis=1))
    shared = np.cov(left, right)[0, 1]
    halves = [part.mean() for part in np.array_split(plain, 2)]
    assert abs(shared / (std**2 * halves[0] * halves[1]) - 1) < 5 * np.sqrt(2 / n)
    capped = jittered.draw(replace(lines, capped=True), np.random.default_rng(seed)).dn
    dark = capped.reshape(n, -1).mean(axis=1).var(ddof=1)
    dark_wanted = ((k * 12.0) ** 2 + 1 / 12) / dn.shape[1]
    assert abs(dark / dark_wanted - 1) < 5 * np.sqrt(2 / n)


@sensors
def test_reciprocity_fails_with_the_light_that_a_pixel_sees_and_not_with_the_exposure(
    model: Model,
) -> None:
    failing = model.with_effect(ReciprocityFailure(exponent=0.05, reference_radiance=20.0))
    for n in (1, 3, 6):
        for exposure_us in (10.0, 40.0):
            seen = sum(LAMPS[:n]) * model.truth().vignette
            wanted = 20.0 * (seen / 20.0) ** 1.05 * exposure_us * model.truth().responsivity
            got = light_dn(failing, at(2, lamps=(1.0,) * n, exposure_us=exposure_us))
            assert np.allclose(got, wanted, rtol=1e-12)


@pytest.mark.parametrize("exponent", [-0.3, 0.3])
def test_no_light_gives_no_response_at_any_exponent(exponent: float) -> None:
    light = np.array([[0.0, 50.0 * 4.0]])
    failing = ReciprocityFailure(exponent=exponent, reference_radiance=4.0)
    assert np.allclose(failing.apply(light, at(1), RNG), light, rtol=1e-15, atol=0)


@pytest.mark.parametrize(("constant", "falls_by"), [("share", 1.0), ("time", 4.0)])
def test_jitter_is_a_share_of_the_exposure_or_a_time(constant: str, falls_by: float) -> None:
    n, effect = 2000, ExposureJitter(0.02, constant, 50.0)
    std = [
        effect.line_factor(at(n, exposure_us=exposure_us), np.random.default_rng()).std()
        for exposure_us in (50.0, 200.0)
    ]
    assert abs(std[0] / 0.02 - 1.0) < 5 / np.sqrt(2 * n)
    assert abs(std[0] / std[1] / falls_by - 1.0) < 5 / np.sqrt(n)
