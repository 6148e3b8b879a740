"""The picoammeter: the contract over a pseudo-terminal, its ranges, its zero, and its faults."""

from typing import Any

import pytest

from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceTimeoutError,
    ProtocolError,
    SettingRefusedError,
)
from drivers.mock.emulators.fault_commands import inject
from drivers.mock.monitor_current import MonitorCurrent
from drivers.mock.world import World
from drivers.serial.keithley6485 import Keithley6485
from tests.contracts.monitor import MonitorContract
from tests.drivers.serial.conftest import LATE_S, Opened, impatient

PER_LAMP_A = 2e-7
# Shot noise of 0.6 µA and the meter's own, at 0.1 power line cycles of 20 ms; 6 sigma.
NOISE_A = 6 * (1.6e-19 * 6e-7 / 2e-3 + 2e-12**2 / 2e-3) ** 0.5


@pytest.fixture
def monitor(opened: Opened) -> Keithley6485:
    return opened.monitor()


class TestEmulatedKeithley6485(MonitorContract):
    pass


@pytest.mark.hardware
class TestHardwareMonitor(MonitorContract):
    @pytest.fixture
    def monitor(self, hardware_bench: Any) -> Any:
        return hardware_bench.monitor


def test_identity_is_read_from_the_meter(monitor: Keithley6485) -> None:
    assert monitor.identity.vendor.startswith("KEITHLEY")
    assert monitor.identity.model == "6485"
    assert monitor.identity.serial == "1088888"


@pytest.mark.parametrize("burning", [0, 1, 3])
@pytest.mark.parametrize("range_a", [None, 1e-6, 2e-6], ids=["auto", "1 µA", "2 µA"])
def test_reads_the_sum_of_the_lamps(
    opened: Opened, world: World, burning: int, range_a: float | None
) -> None:
    for lamp in range(burning):
        world.drive(lamp, 1.0)
    reading = opened.monitor(range_a).read()
    assert reading.current_a == pytest.approx(PER_LAMP_A * burning, abs=NOISE_A)


def test_zero_is_corrected_when_opened(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    # The emulated meter is off by 3 pA, the photodiode's dark current is 2 pA.
    quiet = MonitorCurrent(dark_a=2e-12, meter_std_a=1e-18)
    monkeypatch.setattr(opened.emulated.lines["monitor"].device, "_current", quiet)
    meter = opened.monitor(nplc=1.0)
    # Shot noise of both currents over one cycle of 50 Hz: variance e (2 pA + 3 pA) / 0.02 s.
    noise_a = (1.602e-19 * 5e-12 / 0.02) ** 0.5
    assert meter.read().current_a == pytest.approx(2e-12, abs=5 * noise_a)


def test_out_of_range_is_an_overflow_and_the_next_reading_is_good(
    opened: Opened, world: World
) -> None:
    meter = opened.monitor(range_a=2e-7)
    world.drive(0, 1.0)
    world.drive(1, 1.0)
    with pytest.raises(DeviceError, match="out of range") as caught:
        meter.read()
    assert caught.value.code == "monitor-overflow"
    world.drive(1, 0.0)
    assert meter.read().current_a == pytest.approx(PER_LAMP_A, abs=NOISE_A)


@pytest.mark.parametrize(
    ("range_a", "nplc"), [(0.03, 1.0), (1e-6, 0.001), (1e-6, 60.0)], ids=["range", "short", "long"]
)
def test_setting_that_the_meter_does_not_have_is_refused(
    opened: Opened, range_a: float, nplc: float
) -> None:
    with pytest.raises(SettingRefusedError):
        opened.monitor(range_a, nplc)
    opened.monitor()  # the port is free again


def test_reset_behind_our_back_is_not_read_as_darkness(opened: Opened, world: World) -> None:
    meter = opened.monitor()
    world.drive(0, 1.0)
    opened.emulated.lines["monitor"].device.receive(b"*RST\n")
    with pytest.raises(DeviceError, match="zero check") as caught:
        meter.read()
    assert caught.value.code == "monitor-zero-check"


FAULTS = {
    "garbled": ("monitor garble 1", ProtocolError),
    "truncated": ("monitor truncate 1", DeviceTimeoutError),
    "late": (f"monitor delay {LATE_S} 1", DeviceTimeoutError),
    "silent": ("monitor silent on", DeviceTimeoutError),
    "unplugged": ("monitor vanish", DeviceLostError),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_line_fault_is_named_and_the_next_reading_is_good(
    opened: Opened, world: World, fault: str
) -> None:
    command, kind = FAULTS[fault]
    meter = opened.monitor()
    inject(opened.emulated, command)
    with impatient(meter, when=command.endswith(" on")), pytest.raises(kind) as caught:
        meter.read()
    assert caught.value.last_exchange
    inject(opened.emulated, "monitor return")
    inject(opened.emulated, "monitor mend")
    # Were the late reading taken for the new one, it would show the lamps as they were.
    world.drive(0, 1.0)
    world.drive(1, 1.0)
    assert meter.read().current_a == pytest.approx(2 * PER_LAMP_A, abs=NOISE_A)


def test_two_owners_are_refused(monitor: Keithley6485, opened: Opened) -> None:
    with pytest.raises(DeviceBusyError):
        opened.monitor()
    monitor.read()


def test_another_device_at_the_port_is_refused(opened: Opened) -> None:
    with pytest.raises(DeviceError):
        Keithley6485.open(opened.port("led"), baudrate=115200, timeout_s=0.2)
