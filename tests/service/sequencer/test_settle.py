from math import exp, sin

import pytest

from drivers.ports import never
from service.plan.settle import Settle
from service.sequencer.errors import NotSettledError, RunCancelledError
from service.sequencer.settle import wait_until_steady
from tests.service.sequencer.fake_time import FakeClock, ScriptedMonitor

SETTLE = Settle(tolerance_percent=1.0, stable_for_s=5.0, timeout_s=100.0, interval_s=0.5)


def settled_after(current_a, settle=SETTLE, cancelled=never):
    clock = FakeClock()
    monitor = ScriptedMonitor(clock, current_a)
    return wait_until_steady(monitor, settle, 2.0, clock=clock, cancelled=cancelled)


def test_a_steady_light_takes_the_time_that_it_has_to_be_steady_for():
    assert 5.0 <= settled_after(lambda _t: 1e-6) < 6.5


def test_a_warming_lamp_is_steady_when_its_window_is_flat():
    """With e(t) = 1 - exp(-t / tau), a window of 5 s spans 1 % from t = tau ln(100 c) on."""
    tau_s = 8.0
    seconds = settled_after(lambda t: 1e-6 * (1 - exp(-t / tau_s)))
    spans_s = [t / 100 for t in range(10000) if exp(-t / 100 / tau_s) <= 0.01]
    earliest_s = spans_s[0] - 5.0
    assert earliest_s < seconds < spans_s[0] + 7.0


def test_a_jump_within_the_window_starts_it_again():
    assert settled_after(lambda t: 1e-6 if t < 4.0 else 1.1e-6) >= 4.0 + 5.0


NEVER_STEADY = {
    "rises": (lambda t: 1e-6 * (1 + 0.01 * t), "rose"),
    "falls": (lambda t: 1e-6 * (3 - 0.01 * t), "fell"),
    "fluctuates": (lambda t: 1e-6 * (1 + 0.1 * sin(2.1 * t)), "fluctuated"),
    "reads nothing": (lambda _t: 0.0, "stood between 0 and 0"),
}


@pytest.mark.parametrize(("current_a", "did"), NEVER_STEADY.values(), ids=NEVER_STEADY)
def test_a_time_out_says_what_the_monitor_did(current_a, did):
    with pytest.raises(NotSettledError, match=f"level 2 .*100 s: the monitor {did}") as caught:
        settled_after(current_a)
    assert caught.value.code == "light-not-settled"


def test_a_negative_photocurrent_settles_too():
    assert settled_after(lambda _t: -1e-6) < 6.5


def test_without_a_monitor_it_is_a_wait():
    clock = FakeClock()
    settle = Settle(without_monitor_s=42.0)
    waited_s = wait_until_steady(None, settle, 1.0, clock=clock, cancelled=never)
    assert waited_s == pytest.approx(42.0, abs=0.3)


@pytest.mark.parametrize("has_monitor", [True, False])
def test_waiting_ends_when_cancelled(has_monitor):
    clock = FakeClock()
    monitor = ScriptedMonitor(clock, lambda t: t) if has_monitor else None

    def cancelled():
        return clock.now_s > 103.0

    with pytest.raises(RunCancelledError):
        wait_until_steady(monitor, SETTLE, 1.0, clock=clock, cancelled=cancelled)
    assert clock.now_s < 105.0
