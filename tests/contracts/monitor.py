"""What every monitor promises; subclass `MonitorContract` and give a `monitor` fixture."""

import math
import time

import pytest

from drivers.errors import DeviceError
from drivers.ports import Monitor


class MonitorContract:
    """Promises of `drivers.ports.Monitor`."""

    def test_says_who_it_is(self, monitor: Monitor) -> None:
        assert monitor.identity.vendor
        assert monitor.identity.model
        assert monitor.identity.address

    def test_reads_a_finite_current(self, monitor: Monitor) -> None:
        assert math.isfinite(monitor.read().current_a)

    def test_time_stamp_lies_within_the_call(self, monitor: Monitor) -> None:
        before_ns = time.time_ns()
        reading = monitor.read()
        assert before_ns <= reading.host_timestamp_ns <= time.time_ns()

    def test_measures_anew_each_time(self, monitor: Monitor) -> None:
        assert len({monitor.read().host_timestamp_ns for _ in range(3)}) == 3

    def test_close_twice_is_safe_and_later_calls_fail(self, monitor: Monitor) -> None:
        monitor.close()
        monitor.close()
        with pytest.raises(DeviceError) as caught:
            monitor.read()
        assert caught.value.code == "device-closed"
