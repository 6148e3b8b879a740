"""A whole emulated bench: lamp supplies, an LED, a monitor and a shutter that share one World."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from calib.closing import Closing
from drivers.mock.emulators.gen_chain import GenChain
from drivers.mock.emulators.gen_supply import EmulatedLamp, GenSupply
from drivers.mock.emulators.keithley_6485 import Keithley6485Emulator
from drivers.mock.emulators.mightex_slc import MightexSlc
from drivers.mock.emulators.pty_line import EmulatedDevice, PtyLine
from drivers.mock.emulators.rly16 import Rly16
from drivers.mock.monitor_current import MonitorCurrent
from drivers.mock.world import World


@dataclass(frozen=True)
class BenchSettings:
    """What stands on the bench.

    Attributes:
        lamps: How many; lamp k has the supply with address k, and is the world's lamp k - 1.
        led: Whether there is an LED; it is the world's next lamp.
        lamp: The lamps' rating.
        current: What the monitor sees of them.
        baudrate: Of every line.
        turnaround_s: From the end of a question to the beginning of its answer.
        address_settle_s: How long a newly addressed supply does not listen.
        travel_s: How long the shutter moves.
        seed: Of the monitor's noise; None takes one from the system.
    """

    lamps: int = 6
    led: bool = False
    lamp: EmulatedLamp = field(default_factory=EmulatedLamp)
    current: MonitorCurrent = field(default_factory=MonitorCurrent)
    baudrate: int = 9600
    turnaround_s: float = 0.005
    address_settle_s: float = 0.1
    travel_s: float = 0.1
    seed: int | None = None

    @property
    def addresses(self) -> Sequence[int]:
        """Of the supplies, lamp 1 first."""
        return range(1, self.lamps + 1)


class EmulatedBench(Closing):
    """Serves every device in this process until it is closed.

    Attributes:
        settings: What stands on it.
        lines: By name (`lamps`, `led`, `monitor`, `shutter`); their `faults` and `device` can be
            played with.
        supplies: Of the lamps, by lamp number.
    """

    def __init__(self, world: World, ports: Path, settings: BenchSettings) -> None:
        """Serve at `ports`/lamps and so on; the lamps of `world` go off."""
        needed = settings.lamps + settings.led
        if len(world.state().lamps) < needed:
            raise ValueError(f"{world.path}: a world with {needed} lamps is needed")
        self.settings = settings
        self._world = world
        self.supplies = {
            lamp: GenSupply(lamp, settings.lamp, self._shiner(lamp - 1))
            for lamp in settings.addresses
        }
        ports.mkdir(parents=True, exist_ok=True)
        self.lines = {
            name: PtyLine(
                ports / name,
                device,
                baudrate=settings.baudrate,
                turnaround_s=settings.turnaround_s,
            )
            for name, device in self._devices().items()
        }

    @property
    def ports(self) -> dict[str, str | None]:
        """The paths to open, by name; None where there is no such device."""
        names = ("lamps", "led", "monitor", "shutter")
        return {name: str(self.lines[name].path) if name in self.lines else None for name in names}

    def close(self) -> None:
        """Stop serving; the lamps stay as they are. Safe to call twice."""
        for line in self.lines.values():
            line.stop()
        for line in self.lines.values():
            line.close()

    def _devices(self) -> dict[str, EmulatedDevice]:
        settings, world = self.settings, self._world
        rng = np.random.default_rng(settings.seed)
        devices: dict[str, EmulatedDevice] = {
            "monitor": Keithley6485Emulator(
                lambda: world.state().at_monitor(), rng, current=settings.current
            ),
            "shutter": Rly16(world, travel_s=settings.travel_s),
        }
        if settings.lamps:
            devices["lamps"] = GenChain(self.supplies, address_settle_s=settings.address_settle_s)
        if settings.led:
            devices["led"] = MightexSlc(self._shiner(settings.lamps))
        return devices

    def _shiner(self, index: int) -> Callable[[float, float], None]:
        return lambda emission, tau_s: self._world.drive(index, emission, tau_s=tau_s)
