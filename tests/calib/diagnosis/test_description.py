from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.random import default_rng

from calib.arrays import Columns
from calib.diagnosis.answer.description import describe
from calib.diagnosis.answer.finding import Where
from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.given.known import beside
from calib.diagnosis.naming.remainder import worst
from tests.calib.diagnosis.recordings import plain_model, plan, recorded

COLUMNS = 128


@cache
def clean() -> Evidence:
    rng = default_rng()
    return recorded(plain_model(COLUMNS, taps=2, layout="odd_even"), plan(rng, 60), rng)


def described(course: Columns, pattern: Columns, sigma: float) -> Where:
    """Return the description of a clean recording's means with a pattern added to them."""
    evidence, nothing = clean(), beside(None, clean())
    added = nothing.observed * 0.0
    added = replace(added, means=np.outer(course, pattern))
    point = evidence.point(added)
    scale = sigma / np.sqrt(evidence.product(point, point))
    observed = nothing.observed + added * scale
    residual = evidence.point(observed)
    model = replace(nothing, observed=observed, residual=residual, first=residual)
    look, found = worst(model, evidence)
    assert found > 5.0
    return describe(look, model, evidence)


def tilt() -> Columns:
    return np.linspace(-1.0, 1.0, COLUMNS)


def test_a_tilt_that_comes_with_wall_time_is_smooth_and_follows_time() -> None:
    time = clean().table.mid_s
    where = described(time - time.mean(), tilt(), 60.0)
    assert where.depends_on == ("time",)
    assert "smooth along the columns" in where.text


def test_taps_that_part_with_the_temperature_are_told() -> None:
    temperature = clean().table.temperature_c
    where = described(temperature - temperature.mean(), (-1.0) ** np.arange(COLUMNS), 60.0)
    assert where.depends_on == ("temperature",)
    assert "one level for each tap" in where.text


def test_what_parts_the_taps_is_seen_where_no_pixel_shows_it() -> None:
    # 225 in deviance are 3.5 standard deviations of what all 2,048 free means have of it.
    temperature = clean().table.temperature_c
    where = described(temperature - temperature.mean(), (-1.0) ** np.arange(COLUMNS), 15.0)
    assert where.statistic == "mean"


def test_a_single_column_without_rhyme_or_reason_follows_nothing() -> None:
    pattern = np.zeros(COLUMNS)
    pattern[40] = 1.0
    # White from block to block: of six parabolas one explains 60 % of 18 blocks once in 10^3 runs.
    # Chance in the other columns is some hundred of 160^2: the middle nine tenths are one column.
    where = described(default_rng().standard_normal(clean().n_blocks), pattern, 160.0)
    assert "in a few single columns" in where.text
    assert where.columns[0] <= 40 <= where.columns[1]
    assert where.columns[1] - where.columns[0] < 0.2 * COLUMNS


@pytest.mark.parametrize("sigma", [40.0, 160.0])
def test_what_a_pattern_makes_of_the_remainder_is_told(sigma: float) -> None:
    time = clean().table.mid_s
    text = described(time - time.mean(), tilt(), sigma).text
    share = int(text.split(" makes ")[1].split("%")[0])
    # One pattern is all there is; chance scatters by sqrt(2 x 2300) of 1600 and 25600.
    assert share > (70 if sigma < 100.0 else 97)
