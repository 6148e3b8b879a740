"""Lights that go off before anything else is known of them than their line."""

import time
from collections.abc import Callable

import pytest

from drivers.errors import DeviceBusyError, DeviceNotFoundError
from drivers.mock.world import World
from drivers.serial.blind_off import gen_off, mightex_off
from drivers.serial.port import PortSettings, SerialPort
from tests.drivers.serial.conftest import Opened


def gone_dark(world: World, within_s: float = 10.0) -> bool:
    deadline_s = time.monotonic() + within_s
    while any(lamp.target for lamp in world.state().lamps):
        if time.monotonic() > deadline_s:
            return False
        time.sleep(0.005)
    return True


def half_sent(port: str, text: bytes) -> None:
    """Die in the middle of a command."""
    line = SerialPort(PortSettings(port, "dying", 115200))
    line.write(text)
    line.close()


def test_all_lamps_go_off_behind_a_command_that_was_never_ended(
    opened: Opened, world: World
) -> None:
    lamps = opened.lamps()
    lamps.set_level(3)
    lamps.close()
    assert [lamp.target for lamp in world.state().lamps[:3]] == [1.0] * 3
    half_sent(opened.port("lamps"), b"PC 4.0")
    gen_off(opened.port("lamps"), baudrate=115200)
    assert gone_dark(world)
    assert opened.lamps().state().level == 0.0


def test_an_led_goes_off_behind_a_command_that_was_never_ended(
    opened: Opened, world: World
) -> None:
    led = opened.led()
    led.set_level(1.0)
    led.close()
    assert world.state().lamps[3].target > 0
    half_sent(opened.port("led"), b"CURRENT 1 50")
    mightex_off(opened.port("led"), baudrate=115200)
    assert gone_dark(world)
    assert opened.led().state().level == 0.0


@pytest.mark.parametrize(("off", "name"), [(gen_off, "lamps"), (mightex_off, "led")])
def test_a_line_that_somebody_holds_is_left_to_them(
    opened: Opened, off: Callable[[str], None], name: str
) -> None:
    holder = SerialPort(PortSettings(opened.port(name), "holder", 115200))
    with pytest.raises(DeviceBusyError):
        off(opened.port(name))
    holder.close()


def test_a_port_that_is_not_there_is_said() -> None:
    with pytest.raises(DeviceNotFoundError):
        gen_off("/dev/there-is-no-such-port")
