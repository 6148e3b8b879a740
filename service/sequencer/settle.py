"""Wait until the light is steady."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from drivers.ports import Cancelled, Monitor
from service.plan.settle import Settle
from service.sequencer.clock import Clock, wait
from service.sequencer.errors import NotSettledError, RunCancelledError

_READINGS_AT_LEAST = 3


@dataclass(frozen=True)
class Window:
    """The monitor's latest readings, A, and when they were made, s."""

    times_s: tuple[float, ...]
    currents_a: tuple[float, ...]

    @property
    def span_s(self) -> float:
        """From the first reading to the last."""
        return self.times_s[-1] - self.times_s[0]

    @property
    def spread_percent(self) -> float:
        """Largest minus smallest, of the magnitude of the mean; infinite around 0."""
        mean = abs(float(np.mean(self.currents_a)))
        spread = max(self.currents_a) - min(self.currents_a)
        if spread == 0 and mean > 0:
            return 0.0
        return 100 * spread / mean if mean > 0 else float("inf")

    def in_words(self) -> str:
        """Say what the readings did: rose, fell, or fluctuated."""
        change = self.currents_a[-1] - self.currents_a[0]
        spread = max(self.currents_a) - min(self.currents_a)
        if spread == 0:
            moved = "stood"
        elif abs(change) < 0.7 * spread:
            moved = "fluctuated"
        else:
            moved = "rose" if change > 0 else "fell"
        return (
            f"the monitor {moved} between {min(self.currents_a):.4g} and"
            f" {max(self.currents_a):.4g} A ({self.spread_percent:.2g} %)"
            f" in the last {self.span_s:.3g} s"
        )


def wait_until_steady(
    monitor: Monitor | None, settle: Settle, level: float, *, clock: Clock, cancelled: Cancelled
) -> float:
    """Return after how many seconds the light at `level` was steady.

    Raises:
        NotSettledError: It was not, in `settle.timeout_s`; says what the monitor did.
        RunCancelledError: `cancelled` said so meanwhile.
    """
    started_s = clock.monotonic()
    if monitor is None:
        wait(settle.without_monitor_s, clock, cancelled)
    else:
        _watch(monitor, settle, level, clock=clock, cancelled=cancelled)
    if cancelled():
        raise RunCancelledError
    return clock.monotonic() - started_s


def _watch(
    monitor: Monitor, settle: Settle, level: float, *, clock: Clock, cancelled: Cancelled
) -> None:
    started_s = clock.monotonic()
    readings: deque[tuple[float, float]] = deque()
    while not cancelled():
        readings.append((clock.monotonic(), monitor.read().current_a))
        window = Window(*map(tuple, zip(*readings, strict=True)))
        is_full = window.span_s >= settle.stable_for_s and len(readings) >= _READINGS_AT_LEAST
        if is_full and window.spread_percent <= settle.tolerance_percent:
            return
        if clock.monotonic() - started_s > settle.timeout_s:
            raise _not_settled(window, settle, level)
        # Keep one reading from before the window, so that the rest covers all of it.
        while len(readings) > _READINGS_AT_LEAST and (
            readings[-1][0] - readings[1][0] >= settle.stable_for_s
        ):
            readings.popleft()
        clock.sleep(settle.interval_s)


def _not_settled(window: Window, settle: Settle, level: float) -> NotSettledError:
    return NotSettledError(
        f"the light at level {level:g} was not steady within {settle.tolerance_percent:g} % for"
        f" {settle.stable_for_s:g} s after {settle.timeout_s:g} s: {window.in_words()};"
        " look at the lamp and the monitor, or widen settle.tolerance_percent",
        code="light-not-settled",
    )
