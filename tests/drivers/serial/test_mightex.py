"""The LED on a Mightex controller: the contract over a pseudo-terminal, and its faults."""

import time

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
from drivers.mock.world import World
from drivers.serial.mightex import MightexLed
from tests.contracts.light import LightContract
from tests.drivers.serial.conftest import LATE_S, TIMEOUT_S, Opened, impatient

LED = 3  # the world's lamp after the three lamps


@pytest.fixture
def light(opened: Opened) -> MightexLed:
    return opened.led()


class TestEmulatedMightexLed(LightContract):
    part_level = 0.75


def test_level_is_relative_to_the_nominal_current(light: MightexLed, world: World) -> None:
    state = light.set_level(0.5)  # of 500 mA
    assert state.lamps[0].current_a == pytest.approx(0.25)
    assert state.lamps[0].voltage_v == pytest.approx(2.9)
    assert world.state().emissions(time.monotonic() + 1)[LED] == pytest.approx(0.5)
    assert light.max_level == 2.0


def test_level_is_read_back_at_the_controllers_resolution(light: MightexLed) -> None:
    assert light.set_level(0.3333).level == pytest.approx(167 / 500)


def test_identity_is_read_from_the_controller(light: MightexLed) -> None:
    assert light.identity.model == "SLC-SA04-U/S"
    assert light.identity.serial == "04-081010-002"
    assert light.identity.firmware == "3.1.8"


def test_channel_that_the_controller_does_not_have_is_refused(opened: Opened) -> None:
    led = MightexLed.open(opened.port("led"), channel=5, baudrate=115200, timeout_s=TIMEOUT_S)
    opened.closing.callback(led.close)
    with pytest.raises(SettingRefusedError, match="refuses"):
        led.set_level(1.0)


def test_current_above_the_controllers_ceiling_is_refused(opened: Opened, world: World) -> None:
    led = MightexLed.open(
        opened.port("led"), max_current_ma=2000.0, baudrate=115200, timeout_s=TIMEOUT_S
    )
    opened.closing.callback(led.close)
    with pytest.raises(SettingRefusedError, match="refuses"):
        led.set_level(3.0)
    assert world.state().lamps[LED].target == 0


def test_echo_that_comes_back_after_a_brown_out_is_no_reply(
    light: MightexLed, opened: Opened, world: World
) -> None:
    light.set_level(1.0)
    inject(opened.emulated, "led brown-out")
    assert light.state().level == 0
    assert light.set_level(1.0).level == 1.0
    assert world.state().lamps[LED].target == 1.0


FAULTS = {
    "garbled": ("led garble 1", ProtocolError),
    "truncated": ("led truncate 1", DeviceTimeoutError),
    "late": (f"led delay {LATE_S} 1", DeviceTimeoutError),
    "silent": ("led silent on", DeviceTimeoutError),
    "unplugged": ("led vanish", DeviceLostError),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_line_fault_is_named_and_the_led_goes_off_once_it_is_mended(
    opened: Opened, world: World, fault: str
) -> None:
    command, kind = FAULTS[fault]
    light = opened.led()
    light.set_level(1.0)
    inject(opened.emulated, command)
    with impatient(light, when=command.endswith(" on")), pytest.raises(kind) as caught:
        light.set_level(0.5)
    assert caught.value.last_exchange
    inject(opened.emulated, "led return")
    inject(opened.emulated, "led mend")
    assert light.off().level == 0
    assert world.state().lamps[LED].target == 0


@pytest.mark.parametrize("fault", ["silent", "unplugged"])
def test_off_that_cannot_be_read_back_says_so(opened: Opened, fault: str) -> None:
    command, kind = FAULTS[fault]
    light = opened.led()
    light.set_level(1.0)
    inject(opened.emulated, command)
    with impatient(light), pytest.raises(kind, match="not known to be off") as caught:
        light.off()
    assert caught.value.code == "lamps-not-off"


def test_two_owners_are_refused(light: MightexLed, opened: Opened) -> None:
    with pytest.raises(DeviceBusyError):
        opened.led()
    assert light.set_level(1.0).level == 1.0


def test_another_controller_at_the_port_is_refused(opened: Opened) -> None:
    with pytest.raises(DeviceError):
        MightexLed.open(opened.port("monitor"), baudrate=115200, timeout_s=0.2)
