import pytest

from service.plan.describe import describe, in_words
from service.plan.estimate import estimate
from service.plan.expand import expand
from tests.service.plan.plans import factorial, plan


def test_every_step_has_its_line():
    text = describe(plan())
    lines = text.splitlines()
    assert len(lines) == 7
    assert "capped" in lines[0]
    assert "300.0 µs" in lines[5]
    assert lines[-1].startswith("6 blocks, 384 lines")


def test_exposing_takes_lines_times_their_period():
    given = plan(lines=5000, repeats=2)
    ahead = estimate(given, expand(given), columns=64)
    assert ahead.exposing_s == 2 * 6 * 5000 * 1e-3


def test_only_changes_of_level_are_waited_for_lamp_by_lamp():
    timing = {"lamps": {"ramp_s": 3.0}, "settle": {"stable_for_s": 7.0}}
    along = plan(sweep=factorial(3, 2), order="level_major", **timing)
    across = plan(sweep=factorial(3, 2), **timing)
    assert estimate(along, expand(along), columns=1).waiting_s == 2 * (3.0 + 7.0)
    assert estimate(across, expand(across), columns=1).waiting_s == 6 * (3.0 + 7.0)


def test_lamps_are_lit_one_after_the_other():
    sweep = {"type": "level", "levels": [2, 5, 1], "exposure_us": 100.0}
    given = plan(sweep=sweep, lamps={"ramp_s": 3.0}, settle={"stable_for_s": 7.0}, darks="none")
    assert estimate(given, expand(given), columns=1).waiting_s == (2 + 3 + 4) * 3.0 + 3 * 7.0


def test_waits_and_lamps_that_went_off_are_counted():
    blocks = [{"exposure_us": 100.0, "level": 1, "wait_s": 60.0}] * 2
    given = plan(
        sweep={"type": "listed", "blocks": blocks},
        lamps={"ramp_s": 3.0, "mode": "off_between_blocks"},
        settle={"stable_for_s": 7.0},
    )
    assert estimate(given, expand(given), columns=1).waiting_s == 2 * 70.0


def reading_s(lamps: int, read_back_s: float, **changes) -> float:
    given = plan(source={"lamps": lamps}, lamps={"read_back_s": read_back_s}, **changes)
    return estimate(given, expand(given), columns=1).reading_s


def test_every_supply_is_read_back_after_each_block_and_around_a_change_of_level():
    beside_s = reading_s(6, 0.0)
    per_lamp_s = (reading_s(6, 0.5) - beside_s) / (6 * 0.5)
    assert per_lamp_s == pytest.approx(6 + 3)  # 6 blocks, lit once
    assert beside_s > 0


def test_the_total_is_the_sum_and_is_said():
    given = plan(lines=30_000)
    ahead = estimate(given, expand(given), columns=1)
    assert ahead.total_s == ahead.exposing_s + ahead.waiting_s + ahead.reading_s
    assert f"at least {in_words(ahead.total_s)}" in describe(given)


def test_the_estimated_size_is_not_less_than_the_codes():
    given = plan(lines=1024)
    ahead = estimate(given, expand(given), columns=6144)
    codes = 6 * 1024 * 6144 * 2
    assert codes < ahead.n_bytes < 1.1 * codes


def test_the_size_is_unknown_where_the_columns_are():
    assert "size unknown" in describe(plan(camera={"line_period_us": 1000.0}))
    assert "MB" in describe(plan(camera={"line_period_us": 1000.0}), columns=768)
