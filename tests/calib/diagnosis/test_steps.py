"""Steps within blocks, and the yardstick of the brighter-fatter effect."""

from pathlib import Path

import numpy as np
import pytest

from calib.diagnosis.answer import known_strengths
from calib.diagnosis.statistics.steps import SHORTEST, highest_step
from calib.forward.effects.brighter_fatter import BrighterFatter
from calib.forward.effects.nonlinearity import Nonlinearity

LSST = Path(__file__).parents[3].parent / "shared/data/real/lsst_bf_covariances"


def test_chance_steps_no_more_often_than_is_told() -> None:
    rng = np.random.default_rng(1)
    looks = 30 - 2 * SHORTEST + 1
    p = np.array([highest_step(rng.standard_normal(30))[3] * looks for _ in range(4000)])
    # Bonferroni's bound, and three standard errors of a share of 4000.
    for told in (0.01, 0.05):
        assert (p < told).mean() < told + 3.0 * np.sqrt(told / 4000)
    assert (p < 0.05).mean() > 0.005


def test_a_step_is_found_where_it_is_and_as_high_as_it_is() -> None:
    rng = np.random.default_rng(2)
    z = []
    for _ in range(400):
        values = rng.standard_normal(40)
        values[25:] += 4.0
        first, height, std, chance = highest_step(values)
        assert abs(first - 25) <= 2
        assert chance < 1e-6
        z.append((height - 4.0) / std)
    # The best of all splits is a little too high: by less than a third of its standard error.
    assert abs(np.mean(z)) < 0.33
    assert abs(np.std(z) - 1.0) < 4.0 / np.sqrt(800)


def test_only_a_brighter_fatter_effect_beyond_all_that_is_known_is_remarked() -> None:
    assert known_strengths.remarks([BrighterFatter(), Nonlinearity()]) == ()
    (text,) = known_strengths.remarks([BrighterFatter(column_per_e=2.5e-6)])
    assert "column_per_e" in text
    assert "9 times" in text


@pytest.mark.shared
@pytest.mark.skipif(not LSST.exists(), reason="needs the reference material")
def test_the_yardstick_is_what_the_files_say_and_they_sum_to_nothing() -> None:
    from examples.real.numbers import lsst_covariances

    found = [lsst_covariances(LSST / f"{s}_covariances_21oct19.txt") for s in ("itl", "e2v")]
    places = {"row_per_e": (1, 0), "column_per_e": (0, 1), "corner_per_e": (1, 1)}
    for name, place in places.items():
        assert known_strengths.LSST_PER_E[name] == tuple(float(c[place]) for c in found)
    twice = np.where(np.arange(9) > 0, 2.0, 1.0)
    for covariances in found:
        total = (np.outer(twice, twice) * covariances).sum()
        # 0.1 %, where errors of 80 lags would give 5 % and more: imposed, not measured.
        assert abs(total / covariances[0, 0]) < 0.001
