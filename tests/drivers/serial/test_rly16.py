"""The relay shutter: the contract over a pseudo-terminal, and its faults."""

from typing import Any

import pytest

from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceTimeoutError,
    SettingRefusedError,
)
from drivers.mock.emulators.fault_commands import inject
from drivers.mock.world import World
from drivers.serial.rly16 import RelayShutter
from tests.contracts.shutter import ShutterContract
from tests.drivers.serial.conftest import LATE_S, Opened, impatient


@pytest.fixture
def shutter(opened: Opened) -> RelayShutter:
    return opened.shutter()


class TestEmulatedRelayShutter(ShutterContract):
    pass


@pytest.mark.hardware
class TestHardwareShutter(ShutterContract):
    @pytest.fixture
    def shutter(self, hardware_bench: Any) -> Any:
        return hardware_bench.shutter


def test_cap_has_arrived_when_the_call_returns(shutter: RelayShutter, world: World) -> None:
    for capped in (True, False, True):
        shutter.set_capped(capped)
        assert world.state().capped == capped


def test_other_relays_stay_as_they_are(shutter: RelayShutter, opened: Opened) -> None:
    board = opened.emulated.lines["shutter"].device
    board.receive(b"\x5c\xa4")
    shutter.set_capped(True)
    assert board.receive(b"\x5b")[0].data == b"\xa5"
    shutter.set_capped(False)
    assert board.receive(b"\x5b")[0].data == b"\xa4"


def test_shutter_that_closes_without_power(opened: Opened) -> None:
    shutter = RelayShutter.open(
        opened.port("shutter"), relay=3, capped_when_on=False, travel_s=0.0, baudrate=115200
    )
    opened.closing.callback(shutter.close)
    shutter.set_capped(False)
    assert opened.emulated.lines["shutter"].device.receive(b"\x5b")[0].data == b"\x04"


def test_stuck_relay_is_an_error(shutter: RelayShutter, opened: Opened, world: World) -> None:
    inject(opened.emulated, "shutter stick on")
    with pytest.raises(SettingRefusedError) as caught:
        shutter.set_capped(True)
    assert caught.value.code == "shutter-stuck"
    assert not world.state().capped
    inject(opened.emulated, "shutter stick off")
    shutter.set_capped(True)


FAULTS = {
    "garbled": ("shutter garble 1", DeviceError),  # one byte for another: reads back otherwise
    "truncated": ("shutter truncate 1", DeviceTimeoutError),
    "late": (f"shutter delay {LATE_S} 1", DeviceTimeoutError),
    "silent": ("shutter silent on", DeviceTimeoutError),
    "unplugged": ("shutter vanish", DeviceLostError),
}


@pytest.mark.parametrize("fault", [name for name in FAULTS if name != "garbled"])
def test_line_fault_is_named_and_it_moves_again_once_mended(
    opened: Opened, world: World, fault: str
) -> None:
    command, kind = FAULTS[fault]
    shutter = opened.shutter()
    inject(opened.emulated, command)
    with impatient(shutter, when=command.endswith(" on")), pytest.raises(kind) as caught:
        shutter.set_capped(True)
    assert caught.value.last_exchange
    inject(opened.emulated, "shutter return")
    inject(opened.emulated, "shutter mend")
    for capped in (False, True):
        shutter.set_capped(capped)
        assert world.state().capped == capped


@pytest.mark.parametrize("relay", [0, 9, -1])
def test_relay_that_the_board_does_not_have_is_refused(opened: Opened, relay: int) -> None:
    with pytest.raises(SettingRefusedError, match="no relay"):
        RelayShutter.open(opened.port("shutter"), relay=relay)


def test_two_owners_are_refused(shutter: RelayShutter, opened: Opened) -> None:
    with pytest.raises(DeviceBusyError):
        opened.shutter()
    shutter.set_capped(True)


def test_another_device_at_the_port_is_refused(opened: Opened) -> None:
    with pytest.raises(DeviceError):
        RelayShutter.open(opened.port("monitor"), baudrate=115200, timeout_s=0.2)
