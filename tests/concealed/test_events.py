"""What single events of a recording are worth, held against the likelihood of its codes."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtr

from tests.concealed.generator.answer import happened_in
from tests.concealed.generator.case import Case, Hidden
from tests.concealed.generator.chain import take
from tests.concealed.generator.mechanisms.codes import DuplicatedLines
from tests.concealed.generator.mechanisms.collection import CosmicRays
from tests.concealed.generator.mechanisms.electronics import HeavyTailedNoise
from tests.concealed.generator.scan import Scan
from tests.concealed.ideal.events import event_deviance
from tests.concealed.ideal.expected import Expected, expected
from tests.concealed.ideal.sight import sight
from tests.concealed.scoring.strengths import COMPARED

Floats = NDArray[np.float64]
LONGEST = 9


def drawn_case(name: str, shape: str, rung: float) -> Case:
    return Case(
        0, "single", (Hidden(name, shape, rung),), int(default_rng().integers(2**40)), 60_000
    )


def deviations(case: Case) -> list[tuple[Expected, Floats]]:
    """Return each block without noise, and by how much its codes lie off."""
    setting = case.setting
    taken = take(setting.sensor, setting.plan, case.mechanisms, case.rng("noise"))
    return [(b, t.codes - b.dn) for b, t in zip(expected(setting, ()), taken, strict=True)]


def normal(off: Floats, variance: Floats) -> Floats:
    return np.asarray(-0.5 * off**2 / variance - 0.5 * np.log(2 * np.pi * variance))


def usual(off: Floats, block: Expected) -> Floats:
    return np.asarray(np.maximum(normal(off, block.variance), -138.0))


def scatter(z: Floats) -> float:
    """2 ln R of an event at z standard deviations scatters by 2 z with the noise."""
    return 2.0 * float(np.sqrt((np.minimum(z, 17.0) ** 2).sum()))


def test_tails_are_worth_the_likelihood_ratio_of_their_recording() -> None:
    case = drawn_case("heavy_tailed_noise", "mixture", 0.7)
    (one,) = case.mechanisms
    assert isinstance(one, HeavyTailedNoise)
    blocks, happened = deviations(case), happened_in(case)
    direct, z = 0.0, []
    for (block, off), reads in zip(blocks, happened[one.name], strict=True):
        wide = block.variance + 35.0 * (block.gain * block.scan.sensor.read_noise_e) ** 2
        likelier = one.strength * np.exp(normal(off, wide) - usual(off, block))
        direct += 2.0 * float(np.log1p(likelier - one.strength).sum())
        sigma = np.sqrt(block.variance) / block.gain
        z.append(reads.noise_e / sigma.ravel()[reads.sample])
    seen = event_deviance(one, [block for block, _ in blocks], happened)
    assert abs(direct - seen) < 4.5 * scatter(np.abs(np.concatenate(z))) + 10


def test_rays_are_worth_the_likelihood_ratio_of_their_recording() -> None:
    """Tracks do not overlap: from a line's end on, each pixel begins one, or none."""
    case = drawn_case("cosmic_rays", "short", 0.5)
    (one,) = case.mechanisms
    assert isinstance(one, CosmicRays)
    blocks, happened = deviations(case), happened_in(case)
    direct, z = 0.0, []
    for (block, off), tracks in zip(blocks, happened[one.name], strict=True):
        direct += 2.0 * _lines_with_tracks(one, block, off)
        sigma = np.sqrt(block.variance) / block.gain
        z += [
            t.charge_e / sigma[t.sample, t.row, t.first : t.first + len(t.charge_e)] for t in tracks
        ]
    seen = event_deviance(one, [block for block, _ in blocks], happened)
    # What a track leaves in its pixels is not independent, as the law has it that both use.
    assert abs(direct - seen) < 4.5 * scatter(np.concatenate(z)) + 0.02 * seen + 10


def _lines_with_tracks(one: CosmicRays, block: Expected, off: Floats) -> float:
    sigma, columns = np.sqrt(block.variance), off.shape[2]
    sums = {}
    for n in range(2, LONGEST):
        mean = block.gain * one.strength / n
        charged = log_ndtr(off / sigma - sigma / mean) + 0.5 * (sigma / mean) ** 2 - off / mean
        each = charged - np.log(mean) - usual(off, block)
        sums[n] = np.concatenate([np.zeros((*off.shape[:2], 1)), np.cumsum(each, axis=2)], axis=2)
    found = np.zeros((columns + 1, *off.shape[:2]))
    for k in range(columns - 1, -1, -1):
        terms = [np.log1p(-one.events_per_pixel) + found[k + 1]]
        for n in range(2, min(LONGEST, columns - k + 1)):
            chance = np.log(one.events_per_pixel * 0.6 * 0.4 ** (n - 2))
            terms.append(chance + sums[n][..., k + n] - sums[n][..., k] + found[k + n])
        found[k] = np.logaddexp.reduce(np.array(terms), axis=0)
    return float(found[0].sum())


def test_lines_sent_twice_are_worth_how_unlikely_their_codes_were() -> None:
    case = drawn_case("duplicated_lines", "whole", 0.8)
    (one,) = case.mechanisms
    assert isinstance(one, DuplicatedLines)
    direct = spread = 0.0
    blocks = deviations(case)
    for block, off in blocks:
        again = np.flatnonzero((np.diff(off, axis=0) == 0).all(axis=(1, 2))) + 1
        sigma = np.sqrt(block.variance[0] - 1 / 12)
        chance = ndtr((off[again] + 0.5) / sigma) - ndtr((off[again] - 0.5) / sigma)
        direct -= 2.0 * float(np.log(np.maximum(chance, 1e-30)).sum())
        direct += 2.0 * len(again) * (np.log(one.strength / (1 - one.strength)) - 1.0)
        spread += 2.0 * chance.size  # the square of a normal deviate scatters by sqrt(2)
    seen = event_deviance(one, [block for block, _ in blocks], happened_in(case))
    # Of little noise, the entropy of whole codes is that of rounding's variance to 2 %.
    assert abs(direct - seen) <= 5 * np.sqrt(spread) + 0.02 * direct
    assert sight(case)[0] == pytest.approx(np.sqrt(seen))


def test_of_the_lines_sent_as_many_are_repeats_as_the_scoring_tells() -> None:
    chance, n = 0.1, 100_000
    scan = cast("Scan", SimpleNamespace(n_samples=n))
    lines = np.arange(n).reshape(n, 1, 1)
    sent = DuplicatedLines(chance, "whole").act(lines, scan, {}, default_rng())
    told = COMPARED["duplicated_lines"].true({"parameters": {"strength": chance}}, {})
    # Of as many lines read as fill n: repeats scatter by sqrt(p (1 - p) / (1 + p)^3 / n) of n.
    scatter = np.sqrt(chance * (1.0 - chance) / (1.0 + chance) ** 3 / n)
    assert abs((np.diff(sent.ravel()) == 0).mean() - told) < 4.5 * scatter


@pytest.mark.parametrize("shape", ["whole", "half", "pairs"])
def test_a_recording_in_which_no_line_came_twice_shows_nothing(shape: str) -> None:
    case = drawn_case("duplicated_lines", shape, 0.0)
    (one,) = case.mechanisms
    plain = list(expected(case.setting, ()))
    assert event_deviance(one, plain, {one.name: [0] * len(plain)}) == 0.0
    once = event_deviance(one, plain, {one.name: [1] + [0] * (len(plain) - 1)})
    assert once > 25
    weak = event_deviance(
        replace(one, strength=0.1 * one.strength), plain, {one.name: [1] * len(plain)}
    )
    assert weak > (len(plain) - 1) * 25


def test_a_bit_that_stuck_twice_as_often_as_it_should_is_worth_twice_as_much() -> None:
    from tests.concealed.ideal.distributions import distribution_deviance

    case = drawn_case("stuck_bit", "to_one", 0.6)
    (one,) = case.mechanisms
    plain = list(expected(case.setting, ()))
    each = [distribution_deviance(one, plain, {one.name: [n]}) for n in (0, 100, 200)]
    assert each[0] == 0
    assert each[2] == pytest.approx(2 * each[1])
    assert each[1] > 0
