"""The in-process shutter keeps the contract and moves the world's cap."""

from pathlib import Path

import pytest

from drivers.errors import DeviceLostError, SettingRefusedError
from drivers.mock.shutter import MockShutter
from drivers.mock.world import World
from tests.contracts.shutter import ShutterContract


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World.create(tmp_path / "world", 1)


@pytest.fixture
def shutter(world: World) -> MockShutter:
    return MockShutter(world)


class TestMockShutter(ShutterContract):
    pass


def test_caps_and_uncaps_the_lens(shutter: MockShutter, world: World) -> None:
    shutter.set_capped(True)
    assert world.state().capped
    shutter.set_capped(False)
    assert not world.state().capped


def test_jammed_shutter_is_an_error(shutter: MockShutter) -> None:
    shutter.stuck = True
    with pytest.raises(SettingRefusedError) as caught:
        shutter.set_capped(True)
    assert caught.value.code == "shutter-stuck"


def test_cut_line_raises_and_mends(shutter: MockShutter) -> None:
    shutter.line.fault = "lost"
    with pytest.raises(DeviceLostError):
        shutter.set_capped(True)
    shutter.line.fault = "none"
    shutter.set_capped(True)
