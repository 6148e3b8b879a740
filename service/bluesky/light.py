"""The source as something that moves: its position is its level."""

import threading
from typing import Any

from drivers.ports import LightState
from service.bench.bench import Bench
from service.bluesky.documents import DataKey, Reading, number, reading
from service.bluesky.work_status import WorkStatus

_ENDS_S = 5.0
"""So long a ramp that was called off may take to let go of the line."""


class BenchLight:
    """Movable, readable, locatable. Unstaged, and stopped, it is dark and read back.

    Attributes:
        name: Of the device in documents.
        parent: None, as for every device that stands alone.
    """

    parent = None

    def __init__(self, bench: Bench, name: str = "light") -> None:
        self.name = name
        self._bench = bench
        self._called_off = threading.Event()
        self._moving: WorkStatus | None = None
        self._wanted = 0.0

    def set(self, value: float) -> WorkStatus:
        """Burn at a level; done once it is read back. It may take longer to be steady."""
        level = float(value)
        self._called_off.clear()
        self._wanted = level

        def move() -> None:
            self._bench.light.set_level(level, self._called_off.is_set)

        self._moving = WorkStatus(move, self.name)
        return self._moving

    def locate(self) -> dict[str, float]:
        """Return the level that was asked for last, and the one that is read back."""
        return {"setpoint": self._wanted, "readback": self._bench.light.state().level}

    def read(self) -> dict[str, Reading]:
        """Read level and every lamp's current back."""
        state = self._bench.light.state()
        currents = {
            f"{self.name}_lamp_{n}_current_a": reading(lamp.current_a)
            for n, lamp in enumerate(state.lamps, start=1)
        }
        return {self.name: reading(state.level), **currents}

    def describe(self) -> dict[str, DataKey]:
        """Describe what `read` gives."""
        source = f"{self._bench.id}:light"
        keys = self.read()
        return {key: number(source, "" if key == self.name else "A") for key in keys}

    def stage(self) -> list[Any]:
        """Begin in the dark."""
        self._off()
        return [self]

    def unstage(self) -> list[Any]:
        """End in the dark."""
        self._off()
        return [self]

    def stop(self, success: bool = True) -> None:  # noqa: ARG002  (Bluesky's own)
        """Switch off: a source that is stopped does not burn on."""
        self._off()

    def _off(self) -> LightState:
        """Switch off now, and once more when a ramp has let go: what it had begun may light."""
        self._called_off.set()
        self._wanted = 0.0
        state = self._bench.safe_off()
        if self._moving is not None and not self._moving.done:
            self._moving.wait(_ENDS_S)
            state = self._bench.safe_off()
        return state
