import pytest

from service.plan.expand import expand
from service.sequencer.pace import Pace
from tests.service.sequencer.benches import short_plan
from tests.service.sequencer.fake_time import FakeClock

EXPOSING_S = 10.0


def pace(clock: FakeClock, left=range(6)) -> Pace:
    """Return the pace of six darks and flats of 10 s each, at one level."""
    exposures = [100.0, 200.0, 300.0]
    plan = short_plan(
        sweep={"type": "exposure", "exposures_us": exposures, "level": 1}, lines=10000
    )
    return Pace(plan, expand(plan), clock, list(left))


def test_nothing_is_promised_before_a_step_is_done():
    assert pace(FakeClock()).seconds_left() is None


def test_what_each_step_takes_beyond_the_plan_is_expected_of_the_rest():
    clock = FakeClock()
    running = pace(clock)
    for index in range(3):
        clock.sleep(EXPOSING_S + 2.0)
        running.finish(index)
    assert running.seconds_left() == pytest.approx(3 * (EXPOSING_S + 2.0))
    assert running.elapsed_s == pytest.approx(36.0)


def test_one_lamp_that_warmed_up_for_long_is_not_expected_of_every_step():
    clock = FakeClock()
    running = pace(clock)
    for index, took_s in enumerate([600.0, 10.0, 10.0]):
        clock.sleep(took_s)
        running.finish(index)
    assert running.seconds_left() == pytest.approx(3 * EXPOSING_S)


def test_steps_of_earlier_attempts_and_those_left_out_count_as_done():
    running = pace(FakeClock(), left=[2, 3, 4, 5])
    assert running.done == 2
    running.leave_out(3)
    assert running.done == 3


def test_nothing_is_left_at_the_end():
    clock = FakeClock()
    running = pace(clock, left=[5])
    clock.sleep(1.0)
    running.finish(5)
    assert running.seconds_left() == 0.0
