"""A monitor photodiode without a line: it sees the World's lamps."""

import time

import numpy as np
from numpy.random import Generator

from drivers.errors import DeviceError
from drivers.mock.mock_line import MockLine
from drivers.mock.monitor_current import MonitorCurrent
from drivers.mock.world import World
from drivers.ports import DeviceIdentity, MonitorReading

_DEVICE = "mock monitor"


class MockMonitor:
    """Measures the sum of all lamps, whatever caps the camera.

    Attributes:
        line: Its `fault` cuts the line.
        range_a: Above this it overflows.
    """

    def __init__(
        self,
        world: World,
        rng: Generator,
        *,
        current: MonitorCurrent | None = None,
        integration_s: float = 0.02,
        range_a: float = 2e-5,
    ) -> None:
        self.line = MockLine(_DEVICE)
        self.range_a = range_a
        self._world = world
        self._rng = rng
        self._current = current or MonitorCurrent()
        self._integration_s = integration_s

    @property
    def identity(self) -> DeviceIdentity:
        """A name that says that this is no hardware."""
        return DeviceIdentity("darkflat", "MockMonitor", "M0002", address="in-process")

    def read(self) -> MonitorReading:
        """Integrate, then return the current; `monitor-overflow` above the range."""
        with self.line.exchange():
            time.sleep(self._integration_s)
            emissions = self._world.state().at_monitor()
            current_a = self._current.measure_a(emissions, self._integration_s, self._rng)
        if abs(current_a) > self.range_a:
            raise DeviceError(
                f"{_DEVICE}: out of range; choose a higher range",
                device=_DEVICE,
                code="monitor-overflow",
            )
        return MonitorReading(current_a, time.time_ns())

    def draw_afresh(self) -> None:
        """Draw noise from now on that no seed repeats."""
        self._rng = np.random.default_rng()

    def close(self) -> None:
        """Release it; safe to call twice."""
        self.line.close()
