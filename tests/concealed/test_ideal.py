"""The ideal filter's sight, held against what drawn recordings show."""

from dataclasses import replace

import numpy as np
import pytest

from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.chain import take
from tests.concealed.generator.mechanisms.electronics import LineNoise
from tests.concealed.ideal.angles import nearest_name, signature
from tests.concealed.ideal.correlations import correlation_deviance
from tests.concealed.ideal.expected import expected
from tests.concealed.ideal.means import mean_deviance
from tests.concealed.ideal.scatter import scatter_deviance
from tests.concealed.ideal.sight import sight

MEANS = [
    ("lamp_drift", "linear"), ("stray_light", "uniform"), ("nonlinearity", "quadratic"),
    ("saturation_knee", "linear"), ("dark_current", "gaussian"), ("lag", "each_electron"),
    ("persistence", "one_time"), ("cti", "constant"), ("lamp_flicker", "sine"),
]  # fmt: skip


def case_of(name: str, shape: str, rung: float, seed: int, pixels: int = 60_000) -> Case:
    return Case(0, "single", (Hidden(name, shape, rung),), seed, pixels)


@pytest.mark.parametrize(("name", "shape"), MEANS)
def test_means_of_drawn_codes_deviate_by_what_the_filter_sees_and_their_noise(
    name: str, shape: str
) -> None:
    case = case_of(name, shape, 0.9, 21 if name != "cti" else 40)
    plain = list(expected(case.setting, ()))
    hidden = list(expected(case.setting, case.mechanisms))
    setting = case.setting
    taken = take(setting.sensor, setting.plan, case.mechanisms, case.rng("noise"))
    drawn = [
        replace(block, dn=codes.codes.astype(float))
        for block, codes in zip(plain, taken, strict=True)
    ]
    ratio = np.concatenate([
        (h.variance / p.variance).ravel() for h, p in zip(hidden, plain, strict=True)
    ])  # fmt: skip
    noise = ratio.sum() - 2 * setting.sensor.rows * setting.sensor.columns
    seen = mean_deviance(plain, hidden)
    spread = np.sqrt(2 * (ratio**2).sum() + 4 * seen)
    assert seen > 25
    # Five: charge that is held back has a little less variance than its mean says.
    assert abs(mean_deviance(plain, drawn) - noise - seen) < 5 * spread


@pytest.mark.parametrize("name", ["lamp_drift", "offset_drift", "stray_light", "nonlinearity"])
def test_sight_of_a_shift_is_proportional_to_its_strength(name: str) -> None:
    shape = "linear" if "drift" in name else {"stray_light": "uniform"}.get(name, "quadratic")
    weak, strong = (case_of(name, shape, rung, 22) for rung in (0.3, 0.8))
    ratio = strong.mechanisms[0].strength / weak.mechanisms[0].strength
    assert sight(strong)[0] / sight(weak)[0] == pytest.approx(ratio, rel=0.02)


def test_what_the_baseline_absorbs_is_not_seen() -> None:
    """A share left behind at every charge alike changes responsivities of uniform light alone."""
    for seed in range(30, 60):
        case = case_of("cti", "constant", 1.0, seed)
        if not any(block.image for block in case.setting.plan.blocks):
            assert sight(case)[0] < 0.05
        else:
            assert sight(case)[0] > 1


def test_common_scatter_is_worth_what_line_means_show() -> None:
    """z² of the line means' variance ratio r, small: lines times r²/2."""
    case = case_of("line_noise", "gaussian", 0.5, 23)
    plain = list(expected(case.setting, ()))
    one = case.mechanisms[0]
    assert isinstance(one, LineNoise)
    r = [one.strength**2 * (1 / b.variance[0]).sum() for b in plain]
    n = np.array([b.scan.n_samples for b in plain])
    exact = scatter_deviance(one, plain)
    assert exact == pytest.approx((n * (np.array(r) - np.log1p(r))).sum())
    weak = replace(one, strength=0.1 * one.strength)
    series = (n * (0.01 * np.array(r)) ** 2 / 2).sum()
    assert scatter_deviance(weak, plain) == pytest.approx(series, rel=0.05)


def test_correlations_of_drawn_neighbours_are_what_the_filter_counts_on() -> None:
    case = case_of("interpixel_capacitance", "nearest", 1.0, 24, 300_000)
    setting = case.setting
    plain = list(expected(setting, ()))
    found, pairs = 0.0, 0
    for block in take(setting.sensor, setting.plan, case.mechanisms, case.rng("noise")):
        if block.plan.n_samples < 3:
            continue
        rest = block.codes - block.codes.mean(axis=0)
        rest = rest / rest.std(axis=0, ddof=1)
        rho = (rest[..., 1:] * rest[..., :-1]).mean() * len(rest) / (len(rest) - 1)
        found += rest[..., 1:].size * rho**2
        pairs += 1
    assert not setting.sensor.area
    seen = correlation_deviance(case.mechanisms[0], plain)
    # Each rho² is too large by 1 in units of its own; second order takes a few per cent.
    assert abs(found - pairs - seen) < 4 * np.sqrt(2 * pairs + 4 * seen) + 0.2 * seen


@pytest.mark.soak
def test_every_effect_is_hidden_at_the_lowest_rung_and_clear_at_the_highest() -> None:
    from tests.concealed.generator.catalogue import ALL

    for name, kind in ALL.items():
        if name == "duplicated_lines":  # one is certain, none is nothing
            continue
        lows, highs = [], []
        for seed in (25, 26, 27, 28, 29):
            case = case_of(name, kind.shapes[0], 1.0, seed, 200_000)
            lows.append(sight(case_of(name, kind.shapes[0], 0.0, seed, 200_000))[0])
            highs.append(sight(case)[0])
        assert np.median(highs) > 12, name
        assert np.median(lows) < 4, name


def test_lamp_and_gain_drift_are_near_each_other_and_jitter_is_near_nothing() -> None:
    for name, other in (("lamp_drift", "gain_drift"), ("gain_drift", "lamp_drift")):
        case = case_of(name, "linear", 0.7, 26, 200_000)
        seen = sight(case)
        ((apart, nearest),) = nearest_name(case, seen)
        assert nearest == other
        assert apart < 0.3 * seen[0]
    case = case_of("exposure_jitter", "gaussian", 0.7, 26, 200_000)
    assert nearest_name(case, sight(case)) == [(np.inf, "")]


def test_an_effect_is_no_distance_from_itself() -> None:
    case = case_of("amplifier_glow", "exponential", 0.7, 27, 200_000)
    plain = list(expected(case.setting, ()))
    one = case.mechanisms[0]
    mine = signature(one, plain, case.setting)
    twice = signature(replace(one, strength=2 * one.strength), plain, case.setting)
    cosine = mine @ twice / np.sqrt((mine @ mine) * (twice @ twice))
    assert cosine == pytest.approx(1.0, abs=1e-4)
