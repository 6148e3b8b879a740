"""Whether the lamps of a simulated bench burn, seen from another process."""

import time
from collections.abc import Callable
from pathlib import Path

from drivers.mock.world import World


def is_dark(world: Path) -> bool:
    """Whether no lamp burns, or is on its way to; a world that is gone is dark."""
    try:
        opened = World(world)
    except FileNotFoundError:
        return True
    try:
        return not any(lamp.target for lamp in opened.state().lamps)
    finally:
        opened.close()


def wait_until(
    happens: Callable[[], bool], *, every_s: float = 0.01, within_s: float = 120.0
) -> None:
    """Return once something is so; fails where it takes too long."""
    deadline_s = time.monotonic() + within_s
    while not happens():
        assert time.monotonic() < deadline_s
        time.sleep(every_s)
