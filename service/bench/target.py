"""What stands before the lens: nothing, or the target that a block of kind `scene` names."""

from typing import Protocol

from drivers.errors import DeviceError
from drivers.mock.world import World
from service.bench.operator_shutter import Ask
from service.bench.simulated import Simulated

BAR = "bar"
"""An opaque plate with a slit, a third of the field wide: `calib.forward.scene.bar`."""


class Target(Protocol):
    """Holds targets before the lens."""

    takes_s: float
    """What putting one there takes."""

    def show(self, name: str | None) -> None:
        """Put the target `name` before the lens; None takes away what stands there."""
        ...


class OperatorTarget:
    """Asks a person; assumes that nothing stands there at first."""

    takes_s = 60.0

    def __init__(self, ask: Ask) -> None:
        self._ask = ask
        self._shown: str | None = None

    def show(self, name: str | None) -> None:
        """Ask where something changes."""
        if name == self._shown:
            return
        if name is None:
            self._ask(f"Take the target {self._shown} away from the lens.")
        else:
            self._ask(f"Put the target {name} before the lens and leave it unmoved.")
        self._shown = name


class SimulatedTarget:
    """The slit that simulated cameras know."""

    takes_s = 0.0

    def __init__(self, world: World) -> None:
        self._world = world

    def show(self, name: str | None) -> None:
        """Put it there; DeviceError with code `no-such-target` where it is no slit."""
        if name not in {None, BAR}:
            raise DeviceError(
                f"the simulated bench has no target {name!r}; its cameras see the scene {BAR!r}",
                device="target",
                code="no-such-target",
            )
        self._world.bar(name == BAR)


def open_target(simulated: Simulated | None, ask: Ask | None) -> Target | None:
    """Return who puts targets before the lens; None where nobody can be asked."""
    if simulated is not None:
        return SimulatedTarget(simulated.world)
    return None if ask is None else OperatorTarget(ask)
