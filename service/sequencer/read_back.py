"""What the bench says of itself before and after a block."""

from dataclasses import dataclass

from drivers.ports import LightState
from service.bench.bench import Bench


@dataclass(frozen=True)
class ReadBack:
    """Read at one moment; None is unknown, not 0.

    Attributes:
        light: Every lamp.
        monitor_a: The monitor photodiode's current.
        temperature_c: The sensor's.
    """

    light: LightState
    monitor_a: float | None
    temperature_c: float | None

    @property
    def lamp_currents_a(self) -> tuple[float, ...]:
        """Of each lamp."""
        return tuple(lamp.current_a for lamp in self.light.lamps)


def read_back(bench: Bench, known: LightState | None = None) -> ReadBack:
    """Ask every device; raises what the devices raise.

    Args:
        bench: Whose devices.
        known: The lamps, where they were read just before and nothing was done to them since:
            asking each supply on a slow line takes seconds.
    """
    monitor = bench.monitor
    return ReadBack(
        light=bench.light.state() if known is None else known,
        monitor_a=None if monitor is None else monitor.read().current_a,
        temperature_c=bench.camera.temperature_c(),
    )


def mean(first: float | None, second: float | None) -> float | None:
    """Return the mean of what is known of two readings."""
    known = [value for value in (first, second) if value is not None]
    return sum(known) / len(known) if known else None
