"""An emulated bench whose lines are quick, and its devices opened."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TypeVar

import pytest

from drivers.mock.emulators.bench import BenchSettings, EmulatedBench
from drivers.mock.emulators.gen_supply import EmulatedLamp
from drivers.mock.world import World
from drivers.serial.gen import GenLamps
from drivers.serial.gen_lamp import LampRating
from drivers.serial.keithley6485 import Keithley6485
from drivers.serial.link import SerialLink
from drivers.serial.mightex import MightexLed
from drivers.serial.rly16 import RelayShutter

Device = TypeVar("Device", GenLamps, MightexLed, Keithley6485, RelayShutter)
RATING = LampRating(4.0, 26.0, ramp_step_a=1.0, ramp_step_s=0.001, settle_s=0.1)
SETTLE_S = 0.01
TIMEOUT_S = 1.0
"""Of a reply that comes: a busy machine may take its time."""
LATE_S = 1.5
"""Too late by as much as a busy machine may oversleep, and as long before the link gives up."""


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World.create(tmp_path / "world", 4)


@pytest.fixture
def emulated(world: World, tmp_path: Path) -> Iterator[EmulatedBench]:
    settings = BenchSettings(
        lamps=3,
        led=True,
        lamp=EmulatedLamp(tau_s=0.01),
        baudrate=115200,  # faster than the devices, for tests to be quick
        turnaround_s=0.0005,
        address_settle_s=SETTLE_S,
        travel_s=0.02,
    )
    with EmulatedBench(world, tmp_path / "ports", settings) as bench:
        yield bench


@pytest.fixture
def opened(emulated: EmulatedBench, tmp_path: Path) -> Iterator["Opened"]:
    devices = Opened(emulated, tmp_path)
    with devices.closing:
        yield devices


@contextmanager
def impatient(
    device: GenLamps | MightexLed | Keithley6485 | RelayShutter, *, when: bool = True
) -> Iterator[None]:
    """Have the device's link wait only briefly for replies that will not come."""
    link: SerialLink = device._units.link if isinstance(device, GenLamps) else device._link
    before = link.timeout_s
    if when:
        link.timeout_s = 0.2
    try:
        yield
    finally:
        link.timeout_s = before


class Opened:
    """Opens each device when asked for, and closes it in the end."""

    def __init__(self, emulated: EmulatedBench, folder: Path) -> None:
        self.emulated = emulated
        self.folder = folder
        self.closing = ExitStack()

    def lamps(self, rating: LampRating = RATING) -> GenLamps:
        return self._kept(
            GenLamps.open(
                self.port("lamps"),
                addresses=self.emulated.settings.addresses,
                rating=rating,
                hours_path=self.folder / "hours.json",
                baudrate=115200,
                timeout_s=TIMEOUT_S,
                address_settle_s=SETTLE_S,
            )
        )

    def led(self) -> MightexLed:
        return self._kept(MightexLed.open(self.port("led"), baudrate=115200, timeout_s=TIMEOUT_S))

    def monitor(self, range_a: float | None = None, nplc: float = 0.1) -> Keithley6485:
        return self._kept(
            Keithley6485.open(
                self.port("monitor"),
                range_a=range_a,
                nplc=nplc,
                baudrate=115200,
                timeout_s=TIMEOUT_S,
            )
        )

    def shutter(self) -> RelayShutter:
        return self._kept(
            RelayShutter.open(
                self.port("shutter"), travel_s=0.05, baudrate=115200, timeout_s=TIMEOUT_S
            )
        )

    def port(self, name: str) -> str:
        return str(self.emulated.lines[name].path)

    def _kept(self, device: Device) -> Device:
        self.closing.callback(device.close)
        return device
