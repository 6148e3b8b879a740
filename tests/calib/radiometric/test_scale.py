from dataclasses import replace

import numpy as np
import pytest

from calib.errors import InputError, NotDeterminedError
from calib.radiometric.coefficients.provenance import Provenance
from calib.radiometric.estimation.block_noise import BlockNoise
from calib.radiometric.estimation.common_mode import CommonMode
from calib.radiometric.estimation.common_offset import CommonOffset
from calib.radiometric.estimation.from_statistics import determine
from calib.radiometric.estimation.radiance_table import LevelGroups, group_levels
from calib.radiometric.estimation.scale import radiance_scale
from calib.recording.header import Block
from tests.calib.radiometric.simulated import Bench, draw

QUIET = CommonMode(
    source_unrest=0.0,
    unrest_sigma=0.0,
    offset_noise=BlockNoise(0.0, 5, 0.0),
    block_variance_dn2=np.zeros(0),
    freedom=5,
    mean_slope=1.0,
    by_source=np.zeros((5, 5)),
    offset=CommonOffset(np.zeros((7, 7)), 1.0),
    groups=(1, 2, 3),
)
RELATIVE = np.array([1.0, 2.0, 3.1, 3.9])


def groups(radiance: list[float]) -> LevelGroups:
    return LevelGroups(np.arange(4), np.arange(1.0, 5.0), np.array(radiance))


def test_the_scale_is_the_levels_common_ratio() -> None:
    scale = radiance_scale(groups(list(12.5 * RELATIVE)), RELATIVE, QUIET, 0.003)
    assert scale.radiance_of_reference == pytest.approx(12.5)
    assert scale.by_levels == pytest.approx(0.003 / 2)
    np.testing.assert_allclose(scale.level_ratio, 0.0, atol=1e-12)


def test_a_level_without_radiance_or_without_light_has_no_say() -> None:
    radiance = [12.5, np.nan, 12.5 * 3.1, 999.0]
    relative = np.array([1.0, 2.0, 3.1, np.nan])
    scale = radiance_scale(groups(radiance), relative, QUIET, 0.003)
    assert scale.radiance_of_reference == pytest.approx(12.5)
    assert scale.by_levels == pytest.approx(0.003 / np.sqrt(2))


def test_one_level_is_enough_and_states_what_its_radiance_is_worth() -> None:
    scale = radiance_scale(groups([np.nan, 25.0, np.nan, np.nan]), RELATIVE, QUIET, 0.01)
    assert scale.radiance_of_reference == pytest.approx(12.5)
    assert scale.by_levels == pytest.approx(0.01)


def test_scatter_of_the_levels_is_found_where_none_is_stated() -> None:
    rng = np.random.default_rng()
    found = []
    for _ in range(400):
        radiance = 12.5 * RELATIVE * (1 + 0.02 * rng.standard_normal(4))
        found.append(radiance_scale(groups(list(radiance)), RELATIVE, QUIET, None))
    z = [np.log(s.radiance_of_reference / 12.5) / s.by_levels for s in found]
    assert np.mean([s.level_relative_std**2 for s in found]) == pytest.approx(0.02**2, rel=0.25)
    assert np.median(np.abs(z)) < 0.75


def test_levels_at_odds_with_what_is_stated_are_significant() -> None:
    noisy = replace(QUIET, by_source=np.eye(5) * 1e-10)
    radiance = 12.5 * RELATIVE * np.array([1.0, 1.02, 1.0, 0.98])
    assert radiance_scale(groups(list(radiance)), RELATIVE, noisy, 0.001).scatter_sigma > 10


@pytest.mark.parametrize(
    "bench",
    [
        pytest.param(Bench(level_error=0.003), id="levels-of-their-own"),
        pytest.param(Bench(level_error=0.0, certificate=0.0), id="noise-alone"),
    ],
)
def test_the_bars_of_the_levels_are_their_scatter(bench: Bench) -> None:
    rng, z = np.random.default_rng(), []
    for _ in range(100):
        drawn = draw(bench, rng)
        figures = determine(drawn.statistics, bench.header(), Provenance("0" * 64)).figures
        z.append(figures.level_ratio / figures.level_ratio_std)
    square = np.square(z).mean(axis=1)  # the levels of one recording err together
    chance = 4 * square.std() / np.sqrt(len(square))
    # Where nothing but noise is in the levels, an unrest is found by chance in half of the
    # recordings, and the bars are longer for it: by a tenth at most, two in the square.
    assert -0.2 - chance < square.mean() - 1 < chance
    assert square.std() / np.sqrt(len(square)) < 0.15


def test_the_bars_of_levels_at_one_exposure_are_those_of_independent_errors() -> None:
    scale = radiance_scale(groups(list(12.5 * RELATIVE)), RELATIVE, QUIET, 0.003)
    np.testing.assert_allclose(scale.level_ratio_std, 0.003 * np.sqrt(3 / 4))
    np.testing.assert_allclose(scale.level_ratio_seen_std, 0.0)


def test_no_radiance_is_said() -> None:
    with pytest.raises(NotDeterminedError) as refusal:
        radiance_scale(groups([np.nan] * 4), RELATIVE, QUIET, None)
    assert refusal.value.code == "no-radiance"


def flat(level: float, radiance: float | None) -> Block:
    return Block(block="0", kind="flat", exposure_us=1.0, level=level, radiance=radiance)


def test_a_block_takes_its_levels_radiance_from_another_block() -> None:
    got = group_levels([flat(1, None), flat(1, 12.5), flat(2, None)])
    np.testing.assert_array_equal(got.of_block, [0, 0, 1])
    np.testing.assert_array_equal(got.radiance, [12.5, np.nan])


def test_a_given_table_goes_before_the_recording() -> None:
    got = group_levels([flat(1, 12.5), flat(2, 25.0)], {1.0: 13.0})
    np.testing.assert_array_equal(got.radiance, [13.0, 25.0])


@pytest.mark.parametrize("radiance", [float("nan"), 0.0, -1.0, float("inf")])
def test_a_radiance_that_is_no_radiance_is_refused(radiance: float) -> None:
    with pytest.raises(InputError) as refusal:
        group_levels([flat(1, None)], {1.0: radiance})
    assert refusal.value.code == "bad-radiance"


def test_a_flat_of_radiance_zero_is_refused() -> None:
    with pytest.raises(InputError, match="Block 0 is a flat of radiance 0"):
        group_levels([flat(1, 0.0)])


@pytest.mark.parametrize("n_levels", [2, 3, 4])
def test_two_standard_uncertainties_cover_95_percent_whatever_the_number_of_levels(
    n_levels: int,
) -> None:
    rng, n, covered = np.random.default_rng(), 800, 0
    relative = RELATIVE.copy()
    relative[n_levels:] = np.nan
    for _ in range(n):
        radiance = 12.5 * RELATIVE * (1 + 0.005 * rng.standard_normal(4))
        scale = radiance_scale(groups(list(radiance)), relative, QUIET, None)
        assert scale.freedom == n_levels - 1
        covered += abs(np.log(scale.radiance_of_reference / 12.5)) < 2 * scale.by_levels
    # Student's t with the variance of ν/(ν − 2) is within two of its own a little more often.
    by_chance = 4 * np.sqrt(0.9545 * 0.0455 / n)
    assert 0.9545 - by_chance < covered / n < 0.965 + by_chance


def test_the_reference_is_not_taken_for_exact() -> None:
    """Its level is 1 by definition, but what the camera sees of it is as noisy as of the others."""
    noisy = replace(QUIET, by_source=np.diag([0.0, 1e-4, 1e-4, 1e-4, 1e-4]))
    rng, sigma = np.random.default_rng(), []
    ratio_std = 0.01 / RELATIVE[1:]
    for _ in range(500):
        relative = RELATIVE.copy()
        relative[1:] *= 1 + ratio_std * rng.standard_normal(3)
        found = radiance_scale(groups(list(12.5 * RELATIVE)), relative, noisy, None)
        sigma.append(found.scatter_sigma)
    # Levels that scatter by what the camera adds: a normal number, by Wilson and Hilferty.
    assert abs(np.mean(sigma)) < 4 / np.sqrt(500)
    assert abs(np.std(sigma) - 1) < 4 / np.sqrt(2 * 500)


def test_of_one_level_the_slopes_own_error_is_the_scales() -> None:
    noisy = replace(QUIET, mean_slope=2.0, by_source=np.diag([0.0, 4e-4, 0.0, 0.0, 0.0]))
    scale = radiance_scale(groups([12.5, np.nan, np.nan, np.nan]), RELATIVE, noisy, 0.0)
    assert scale.by_source_unrest == pytest.approx(0.02 / 2.0)
