"""The chain around a fitted response against lines that the forward model draws."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.forward.conditions import Conditions
from calib.forward.departure import Departure
from calib.forward.effect import Effect
from calib.forward.effects.catalogue import CATALOGUE, effect_named
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.effects.shot_noise import ShotNoise
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.model import Model
from calib.radiometric.departures.fitted_chain import FittedChain, Response, carried
from tests.calib.radiometric.departures.cases import CASES, MODEL, scene_radiance

N_LINES, DRAWS, SIGMA = 32, 60, 5.0
LAMPS = (1.0, 1.0)
AT = Conditions.steady(
    N_LINES, exposure_us=100.0, line_period_us=1400.0, lamps=LAMPS, started_s=0.3,
    sensor_temperature_c=28.0,
)  # fmt: skip
SCATTERS = (
    effect_named("line_noise")(std_dn=1.0),
    effect_named("heavy_tailed_noise")(share=0.05, std_e=50.0),
    effect_named("lag")(share=0.1, partition_noise=0.0),
    effect_named("cti")(per_transfer=1e-3),
    effect_named("exposure_jitter")(relative_std=0.005),
    effect_named("lamp_flicker")(amplitude=0.02),
    effect_named("banding")(),
    effect_named("rts_pixels")(share=0.1),
    effect_named("cosmic_rays")(per_pixel_s=3.0),
)
LEFT_ALONE = {"adc_dnl", "stuck_bit", "black_clip", "duplicated_lines"}


def around(model: Model) -> FittedChain:
    """The model's departures around its own truth."""
    truth = MODEL.truth()
    vignette, gain = model.effect("vignette"), model.effect("system_gain")
    assert isinstance(vignette, Vignette)
    assert isinstance(gain, SystemGain)
    response = Response(truth.vignette * truth.responsivity, truth.dark_offset_dn)
    noise = (ShotNoise(), ReadNoise(truth.read_noise_e))
    return FittedChain(carried(model.effects), vignette, gain, 0.0, response, noise)


def drawn(model: Model, scene: NDArray[np.float64]) -> NDArray[np.float64]:
    """Codes, (DRAWS, N_LINES, columns)."""
    rng = default_rng()
    return np.array([model.draw(AT, rng, scene).dn for _ in range(DRAWS)], np.float64)


def test_every_departure_is_in_these_tests() -> None:
    known = {case.name for case in CASES} | {e.name for e in SCATTERS} | LEFT_ALONE
    assert known == {kind.name for kind in CATALOGUE if issubclass(kind, Departure)}


def test_what_changes_single_codes_or_lines_is_left_alone() -> None:
    effects = tuple(effect_named(name)() for name in LEFT_ALONE)
    assert carried(effects) == ()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_expectation_is_the_mean_of_what_is_drawn(case) -> None:
    scene = scene_radiance(N_LINES)
    codes = drawn(case.model, scene)
    expected, _ = around(case.model).expected(scene + 10.0 * sum(LAMPS), AT)
    z = (codes.mean(axis=0) - expected) / (codes.std(axis=0, ddof=1) / np.sqrt(DRAWS))
    # Student's t of 59 degrees of freedom: variance 59/57, of its square 2.3 or so.
    freedom = DRAWS - 1
    wanted = freedom / (freedom - 2)
    assert abs(np.mean(z**2) - wanted) < SIGMA * np.sqrt(2.4 / z.size)
    assert abs(z.mean()) < SIGMA / np.sqrt(z.size)


@pytest.mark.parametrize(
    "effect", [*SCATTERS, *(c.effect for c in CASES if c.by_covariance)], ids=lambda e: e.name
)
def test_noise_of_common_random_numbers_has_the_variance_of_what_is_drawn(effect: Effect) -> None:
    model, scene = MODEL.with_effect(effect), scene_radiance(N_LINES)
    codes = drawn(model, scene)
    chain, light = around(model), scene + 10.0 * sum(LAMPS)
    smooth = np.array([chain.drawn(light, AT, [k]) for k in range(DRAWS)])
    found = smooth.var(axis=0, ddof=1).mean(axis=1)
    true = codes.var(axis=0, ddof=1).mean(axis=1) - 1.0 / 12.0
    # By line, averaged over columns: what columns share does not average out over them.
    ratio = found / true
    error = ratio.std(ddof=1) / np.sqrt(N_LINES)
    assert abs(ratio.mean() - 1.0) < SIGMA * max(error, np.sqrt(2.0 / scene.size / DRAWS))


def test_links_draw_the_same_whatever_else_is_there() -> None:
    scene = scene_radiance(N_LINES)
    chain = around(MODEL.with_effect(effect_named("interpixel_capacitance")(column_coupling=0.0)))
    plain = around(MODEL)
    np.testing.assert_array_equal(chain.drawn(scene, AT, [3]), plain.drawn(scene, AT, [3]))


def test_a_column_without_a_slope_has_that_of_the_others() -> None:
    slope = np.array([1.0, np.nan, 3.0, 2.0, -1.0])
    dark = np.array([10.0, 11.0, np.nan, 12.0, 13.0])
    filled = Response.filled(slope, dark)
    np.testing.assert_array_equal(filled.slope, [1.0, 1.5, 1.5, 2.0, 1.5])
    np.testing.assert_array_equal(filled.dark_dn, [10.0, 11.0, 11.0, 12.0, 11.0])
