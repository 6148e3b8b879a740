"""A shutter without a line: it caps the World's lens."""

import time

from drivers.errors import SettingRefusedError
from drivers.mock.mock_line import MockLine
from drivers.mock.world import World
from drivers.ports import DeviceIdentity

_DEVICE = "mock shutter"


class MockShutter:
    """Moves the cap of a World.

    Attributes:
        line: Its `fault` cuts the line.
        stuck: True as if jammed.
    """

    def __init__(self, world: World, *, travel_s: float = 0.01) -> None:
        self.line = MockLine(_DEVICE)
        self.stuck = False
        self._world = world
        self._travel_s = travel_s

    @property
    def identity(self) -> DeviceIdentity:
        """A name that says that this is no hardware."""
        return DeviceIdentity("darkflat", "MockShutter", "M0003", address="in-process")

    def set_capped(self, capped: bool) -> None:
        """Move, and return once it is there; `shutter-stuck` when it did not move."""
        with self.line.exchange():
            time.sleep(self._travel_s)
            if not self.stuck:
                self._world.cap(capped)
            if self._world.state().capped != capped:
                raise SettingRefusedError(
                    f"{_DEVICE}: did not move", device=_DEVICE, code="shutter-stuck"
                )

    def close(self) -> None:
        """Release it; safe to call twice."""
        self.line.close()
