"""Lamps on GEN supplies, over a pseudo-terminal: the contract, and each fault of line and lamps."""

import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import pytest

from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceNotFoundError,
    DeviceTimeoutError,
    ProtocolError,
    SettingRefusedError,
)
from drivers.mock.emulators.fault_commands import inject
from drivers.mock.world import World
from drivers.serial.gen import GenLamps
from drivers.serial.gen_lamp import GenLamp, LampRating
from drivers.serial.gen_units import UnitReading
from tests.contracts.light import LightContract
from tests.drivers.serial.conftest import (
    LATE_S,
    RATING,
    SETTLE_S,
    TIMEOUT_S,
    Opened,
    impatient,
)


@pytest.fixture
def light(opened: Opened) -> GenLamps:
    return opened.lamps()


class TestEmulatedGenLamps(LightContract):
    part_level = 2.0


@pytest.mark.hardware
class TestHardwareLight(LightContract):
    part_level = 1.0

    @pytest.fixture
    def light(self, hardware_bench: Any) -> Any:
        return hardware_bench.light


def _emissions_when_settled(world: World) -> tuple[float, ...]:
    return world.state().emissions(time.monotonic() + 10.0)


def test_level_n_burns_the_first_n_lamps_at_nominal(light: GenLamps, world: World) -> None:
    state = light.set_level(2)
    assert [lamp.on for lamp in state.lamps] == [True, True, False]
    assert [lamp.current_a for lamp in state.lamps] == pytest.approx([4.0, 4.0, 0.0])
    assert [lamp.voltage_v for lamp in state.lamps] == pytest.approx([24.0, 24.0, 0.0])
    assert _emissions_when_settled(world)[:3] == pytest.approx((1.0, 1.0, 0.0))


def test_current_is_ramped_up_in_steps(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    supply = opened.emulated.supplies[1]
    currents: list[str] = []
    obey = supply.obey

    def noted(command: str) -> str:
        if command.startswith("PC "):
            currents.append(command)
        return obey(command)

    monkeypatch.setattr(supply, "obey", noted)
    light = opened.lamps()
    light.set_level(1)
    assert currents == ["PC 0.000", "PC 1.000", "PC 2.000", "PC 3.000", "PC 4.000"]
    light.set_level(0)
    assert currents[5:] == ["PC 3.000", "PC 2.000", "PC 1.000", "PC 0.000"]


def test_lamp_that_burns_already_is_not_ramped_again(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    light = opened.lamps()
    light.set_level(1)
    supply = opened.emulated.supplies[1]
    commands: list[str] = []
    obey = supply.obey

    def noted(command: str) -> str:
        commands.append(command)
        return obey(command)

    monkeypatch.setattr(supply, "obey", noted)
    light.set_level(2)
    assert not [command for command in commands if not command.endswith("?")]


def test_a_voltage_limit_that_other_software_left_is_put_right(opened: Opened) -> None:
    supply = opened.emulated.supplies[1]
    light = opened.lamps()
    for command in ("RMT REM", "PV 30.000", "PC 1.000", "OUT ON"):
        assert supply.obey(command) == "OK"
    light.set_level(1)
    assert float(supply.obey("PV?")) == RATING.voltage_limit_v


def test_opening_and_closing_leave_the_lamps_as_they_are(opened: Opened, world: World) -> None:
    opened.lamps().set_level(2)
    opened.closing.close()
    reopened = opened.lamps()
    assert reopened.state().level == 2
    assert world.state().lamps[1].target == pytest.approx(1.0)


def test_opened_dark_even_those_go_off_whose_neighbour_does_not_answer(
    opened: Opened, world: World
) -> None:
    light = opened.lamps()
    light.set_level(2)
    light._units.link.port.write(b"PC 1.")  # what a killed program leaves half said
    opened.closing.close()
    with pytest.raises(DeviceNotFoundError, match="address 9"):
        GenLamps.open(
            opened.port("lamps"),
            addresses=[9, 1],
            rating=RATING,
            baudrate=115200,
            timeout_s=0.2,
            address_settle_s=SETTLE_S,
            dark=True,
        )
    assert [lamp.target for lamp in world.state().lamps[:3]] == [0.0] * 3
    assert opened.lamps().state().level == 0


def test_part_of_a_lamp_is_refused(light: GenLamps) -> None:
    with pytest.raises(SettingRefusedError, match="whole number of lamps"):
        light.set_level(0.5)


def test_cancelled_ramp_ends_where_it_is(light: GenLamps) -> None:
    steps = iter([False] * 5 + [True] * 100)
    state = light.set_level(1, cancelled=lambda: next(steps))
    assert state.level == 0
    assert 0 < state.lamps[0].current_a < 4.0


def test_absent_supply_is_named_at_opening(opened: Opened) -> None:
    with pytest.raises(DeviceNotFoundError, match="address 9"):
        GenLamps.open(
            opened.port("lamps"),
            addresses=[1, 9],
            rating=RATING,
            baudrate=115200,
            timeout_s=TIMEOUT_S,
            address_settle_s=SETTLE_S,
        )
    assert opened.lamps().state().level == 0  # the port is free again


def test_too_short_a_wait_after_addressing_is_noticed(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(opened.emulated.lines["lamps"].device, "_settle_s", 5.0)
    with pytest.raises(DeviceNotFoundError):
        GenLamps.open(
            opened.port("lamps"),
            addresses=[1],
            rating=RATING,
            baudrate=115200,
            timeout_s=0.2,
            address_settle_s=0.1,
        )


def test_two_owners_are_refused(light: GenLamps, opened: Opened) -> None:
    with pytest.raises(DeviceBusyError):
        opened.lamps()
    assert light.set_level(1).level == 1


LINE_FAULTS = {
    "garbled": ("lamps garble 1", ProtocolError, "reply-garbled"),
    "truncated": ("lamps truncate 1", DeviceTimeoutError, "device-timeout"),
    "late": (f"lamps delay {LATE_S} 1", DeviceTimeoutError, "device-timeout"),
    "silent": ("lamps silent on", DeviceTimeoutError, "device-timeout"),
    "deaf": ("lamps deaf on", DeviceTimeoutError, "device-timeout"),
    "unplugged": ("lamps vanish", DeviceLostError, "device-lost"),
}


@pytest.mark.parametrize("fault", LINE_FAULTS)
def test_line_fault_while_reading_back_is_named_and_lamps_go_off_once_it_is_mended(
    opened: Opened, world: World, fault: str
) -> None:
    command, kind, code = LINE_FAULTS[fault]
    light = opened.lamps()
    light.set_level(3)
    inject(opened.emulated, command)
    with impatient(light, when=command.endswith(" on")), pytest.raises(kind) as caught:
        light.state()
    assert caught.value.code == code
    assert caught.value.device.startswith("lamps at ")
    assert caught.value.last_exchange
    inject(opened.emulated, "lamps return")
    inject(opened.emulated, "lamps mend")
    assert light.off().level == 0
    assert all(lamp.target == 0 for lamp in world.state().lamps)
    assert light.set_level(1).level == 1


@pytest.mark.parametrize("fault", [name for name in LINE_FAULTS if name != "deaf"])
def test_line_fault_while_a_ramp_runs_ends_with_the_lamps_off_or_named(
    opened: Opened, world: World, fault: str
) -> None:
    command, kind, code = LINE_FAULTS[fault]
    light = opened.lamps()
    light.set_level(1)
    asked = iter(range(1000))
    with ExitStack() as waiting:

        def inject_in_the_third_step() -> bool:
            if next(asked) == 3:
                inject(opened.emulated, command)
                waiting.enter_context(impatient(light, when=command.endswith(" on")))
            return False

        with pytest.raises(kind) as caught:
            light.set_level(3, cancelled=inject_in_the_third_step)
    assert caught.value.code == code
    if command.endswith(" 1"):  # a fault that passes: what failed left nothing lit
        assert not hasattr(caught.value, "__notes__")
        assert light.state().level == 0
    else:
        assert "lamp 1, 2, 3" in caught.value.__notes__[0]
    inject(opened.emulated, "lamps return")
    inject(opened.emulated, "lamps mend")
    assert light.off().level == 0
    assert all(lamp.target == 0 for lamp in world.state().lamps)


def test_off_reaches_lamps_that_hear_but_do_not_answer(opened: Opened, world: World) -> None:
    light = opened.lamps()
    light.set_level(3)
    inject(opened.emulated, "lamps silent on")
    with impatient(light), pytest.raises(DeviceError, match="lamp 1, 2, 3") as caught:
        light.off()
    assert caught.value.code == "lamps-not-off"
    assert isinstance(caught.value, DeviceTimeoutError)
    assert all(lamp.target == 0 for lamp in world.state().lamps)


@pytest.mark.parametrize("spoil", ["truncate", "garble", f"delay {LATE_S}"])
def test_off_asks_once_more_where_a_single_reply_got_lost(
    opened: Opened, world: World, spoil: str
) -> None:
    light = opened.lamps()
    light.set_level(3)
    inject(opened.emulated, f"lamps {spoil} 1")
    assert light.off().level == 0
    assert all(lamp.target == 0 for lamp in world.state().lamps)


def test_off_on_a_line_that_is_gone_is_a_loss_that_names_every_lamp(opened: Opened) -> None:
    light = opened.lamps()
    light.set_level(2)
    inject(opened.emulated, "lamps vanish")
    with pytest.raises(DeviceLostError, match="lamp 1, 2, 3") as caught:
        light.off()
    assert caught.value.code == "lamps-not-off"


LAMP_FAULTS = {
    "brown-out": ("lamp 2 brown-out", "setting-refused"),  # E07: on during a fault
    "sagging mains": ("lamp 2 sag 0.8", "lamp-not-in-current-mode"),
    "broken filament": ("lamp 2 burn-out", "lamp-not-in-current-mode"),
}


@pytest.mark.parametrize("fault", LAMP_FAULTS)
def test_lamp_fault_is_named_and_everything_goes_off(
    opened: Opened, world: World, fault: str
) -> None:
    command, code = LAMP_FAULTS[fault]
    light = opened.lamps()
    light.set_level(2)
    inject(opened.emulated, command)
    assert light.state().level == 1  # it shows at once when read back
    with pytest.raises(DeviceError, match="lamp 2") as caught:
        light.set_level(3)
    assert caught.value.code == code
    assert all(lamp.target == 0 for lamp in world.state().lamps)
    inject(opened.emulated, "lamp 2 restore")
    assert light.set_level(3).level == 3


def test_brown_out_during_the_ramp_is_named(opened: Opened, world: World) -> None:
    light = opened.lamps()
    asked = iter(range(1000))

    def fail_lamp_1_while_lamp_2_ramps() -> bool:
        if next(asked) == 10:
            inject(opened.emulated, "lamp 1 brown-out")
        return False

    with pytest.raises(DeviceError, match=r"lamp 1 .*: its supply reports: mains failed") as caught:
        light.set_level(2, cancelled=fail_lamp_1_while_lamp_2_ramps)
    assert caught.value.code == "lamp-fault"
    assert all(lamp.target == 0 for lamp in world.state().lamps)


def test_switching_on_during_a_fault_is_refused_by_the_supply(opened: Opened) -> None:
    light = opened.lamps()
    inject(opened.emulated, "lamp 1 brown-out")
    with pytest.raises(SettingRefusedError, match=r"lamp 1 .* during a fault"):
        light.set_level(1)


def test_voltage_that_the_supply_does_not_have_is_refused(opened: Opened) -> None:
    light = opened.lamps(LampRating(4.0, 60.0, ramp_step_s=0.0))
    with pytest.raises(SettingRefusedError, match="out of range"):
        light.set_level(1)


def test_voltage_limit_below_the_lamps_voltage_is_named(opened: Opened) -> None:
    light = opened.lamps(LampRating(4.0, 20.0, ramp_step_a=1.0, ramp_step_s=0.0, settle_s=0.05))
    with pytest.raises(SettingRefusedError, match="voltage limit is too low") as caught:
        light.set_level(1)
    assert caught.value.code == "lamp-not-in-current-mode"


def test_off_does_not_wait_for_the_ramp(opened: Opened, world: World) -> None:
    # A ramp of 4000 steps of 50 ms takes minutes; if `off` waited for it, this would time out.
    light = opened.lamps(LampRating(4.0, 26.0, ramp_step_a=0.001, ramp_step_s=0.05))
    burning = threading.Event()
    outcome: list[DeviceError] = []

    def goes_on() -> bool:
        burning.set()
        return False

    def ramp() -> None:
        with pytest.raises(DeviceError) as caught:
            light.set_level(3, cancelled=goes_on)
        outcome.append(caught.value)

    thread = threading.Thread(target=ramp)
    thread.start()
    assert burning.wait(10)
    while opened.emulated.supplies[1].obey("OUT?") != "ON":
        time.sleep(0.01)
    assert light.off().level == 0
    thread.join(10)
    assert not thread.is_alive()
    assert outcome[0].code == "switched-off"
    assert light.state().level == 0
    assert all(lamp.target == 0 for lamp in world.state().lamps)


def test_an_order_to_go_off_ends_the_reading_of_all_lamps(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    light = opened.lamps()
    light.set_level(3)
    read, asked = GenLamp.read, []

    def then_off(lamp: GenLamp) -> UnitReading:
        asked.append(lamp.unit.lamp)
        reading = read(lamp)
        light.order_off()
        return reading

    monkeypatch.setattr(GenLamp, "read", then_off)
    with pytest.raises(DeviceError) as caught:
        light.state()
    assert caught.value.code == "switched-off"
    assert asked == [1]


def test_of_two_who_switch_off_at_once_one_reads_back_for_both(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    light = opened.lamps()
    light.set_level(3)
    read, asked, levels = GenLamp.read, [], []
    second = threading.Thread(target=lambda: levels.append(light.off().level))

    def read_while_another_waits(lamp: GenLamp) -> UnitReading:
        asked.append(lamp.unit.lamp)
        if second.ident is None:
            orders = light._orders.count
            second.start()
            while light._orders.count == orders:
                time.sleep(0.001)
            time.sleep(0.05)  # on its way to the line's lock, which this thread holds
        return read(lamp)

    monkeypatch.setattr(GenLamp, "read", read_while_another_waits)
    assert light.off().level == 0
    second.join(10)
    assert levels == [0]
    assert asked == [1, 2, 3]
    assert light.off().level == 0  # later than that: asked anew
    assert asked == [1, 2, 3] * 2


def _fails(call: Callable[[], object]) -> None:
    with pytest.raises(DeviceError):
        call()


def test_off_goes_out_while_a_reply_is_awaited(opened: Opened, world: World) -> None:
    light = opened.lamps()
    light.set_level(3)
    inject(opened.emulated, "lamps silent on")
    link = light._units.link
    link.timeout_s = 60.0
    waiting = threading.Thread(target=_fails, args=(light.state,))
    waiting.start()
    while link.in_step:
        time.sleep(0.001)
    off = threading.Thread(target=_fails, args=(light.off,))
    off.start()
    while any(lamp.target for lamp in world.state().lamps):
        time.sleep(0.005)
    assert waiting.is_alive()  # dark although that question is still open
    inject(opened.emulated, "lamps vanish")  # which ends all waiting
    off.join(20)
    waiting.join(20)
    assert not off.is_alive()
    assert not waiting.is_alive()


def test_lamp_hours_survive_the_program(opened: Opened) -> None:
    light = opened.lamps()
    light.set_level(1)
    time.sleep(0.05)
    light.off()
    first = light.state().lamps[0].hours
    opened.closing.close()
    again = opened.lamps()
    assert first is not None
    assert first > 0.05 / 3600
    assert again.state().lamps[0].hours == pytest.approx(first)
    assert again.state().lamps[2].hours == 0
