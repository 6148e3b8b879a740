"""The in-process lamps keep the contract, warm up, and fail when told to."""

import time
from pathlib import Path

import pytest

from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError, SettingRefusedError
from drivers.mock.light import MockLight
from drivers.mock.mock_line import Fault
from drivers.mock.world import World
from tests.contracts.light import LightContract


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World.create(tmp_path / "world", 3)


@pytest.fixture
def light(world: World) -> MockLight:
    return MockLight(world, tau_s=0.001)


class TestMockLight(LightContract):
    part_level = 2.0


def test_burning_lamps_light_the_world(light: MockLight, world: World) -> None:
    light.set_level(2)
    after_warming_up_s = time.monotonic() + 1.0
    assert world.state().emissions(after_warming_up_s) == pytest.approx((1.0, 1.0, 0.0))


def test_lamps_warm_up_with_their_time_constant(world: World) -> None:
    MockLight(world, tau_s=10.0).set_level(1)
    lamp = world.state().lamps[0]
    gap_now = 1.0 - lamp.emission(lamp.since_s)
    gap_after_tau = 1.0 - lamp.emission(lamp.since_s + 10.0)
    assert gap_after_tau == pytest.approx(gap_now / 2.718281828)


def test_part_of_a_lamp_is_refused(light: MockLight) -> None:
    with pytest.raises(SettingRefusedError, match="whole number of lamps"):
        light.set_level(1.5)


def test_lamp_hours_count_while_it_burns(light: MockLight) -> None:
    light.set_level(1)
    burnt, dark = light.state().lamps[0].hours, light.state().lamps[2].hours
    assert burnt is not None
    assert burnt > 0
    assert dark == 0


@pytest.mark.parametrize(
    ("fault", "kind"), [("lost", DeviceLostError), ("silent", DeviceTimeoutError)]
)
def test_cut_line_raises_leaves_the_lamps_and_mends(
    light: MockLight, world: World, fault: Fault, kind: type[DeviceError]
) -> None:
    light.set_level(2)
    light.line.fault = fault
    for call in (light.state, light.off, lambda: light.set_level(1)):
        with pytest.raises(kind):
            call()
    assert world.state().lamps[0].target == pytest.approx(1.0)
    light.line.fault = "none"
    assert light.off().level == 0


def test_broken_lamp_is_named_and_nothing_stays_lit(light: MockLight, world: World) -> None:
    light.broken.add(2)
    with pytest.raises(SettingRefusedError, match="lamp 2") as caught:
        light.set_level(3)
    assert caught.value.code == "lamp-dark"
    assert all(lamp.target == 0 for lamp in world.state().lamps)


def test_lamp_that_does_not_go_off_is_named(light: MockLight) -> None:
    light.set_level(3)
    light.stuck.add(3)
    with pytest.raises(DeviceError, match="lamp 3") as caught:
        light.off()
    assert caught.value.code == "lamps-not-off"


def test_brown_out_shows_when_read_back(light: MockLight) -> None:
    light.set_level(3)
    light.brown_out(1)
    state = light.state()
    assert state.level == 2
    assert not state.lamps[0].on
