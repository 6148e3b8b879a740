"""The in-process monitor keeps the contract and sees the world's lamps with physical noise."""

from pathlib import Path

import numpy as np
import pytest

from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError
from drivers.mock.mock_line import Fault
from drivers.mock.monitor import MockMonitor
from drivers.mock.monitor_current import MonitorCurrent
from drivers.mock.world import World
from tests.contracts.monitor import MonitorContract


@pytest.fixture
def world(tmp_path: Path) -> World:
    return World.create(tmp_path / "world", 3)


@pytest.fixture
def monitor(world: World) -> MockMonitor:
    return MockMonitor(world, np.random.default_rng(4), integration_s=0.001)


class TestMockMonitor(MonitorContract):
    pass


@pytest.mark.parametrize("burning", [0, 1, 3])
def test_current_is_the_sum_of_the_lamps(world: World, burning: int) -> None:
    current = MonitorCurrent(amperes_per_lamp=1e-7, dark_a=1e-12, meter_std_a=1e-13)
    monitor = MockMonitor(world, np.random.default_rng(5), current=current, integration_s=0.01)
    for lamp in range(burning):
        world.drive(lamp, 1.0)
    std_a = (1.6e-19 * 1e-7 * burning / 0.01 + 1e-26 / 0.01) ** 0.5
    assert monitor.read().current_a == pytest.approx(burning * 1e-7 + 1e-12, abs=6 * std_a)


@pytest.mark.parametrize("seed", range(4))
def test_noise_is_shot_noise_and_the_meters(seed: int) -> None:
    current = MonitorCurrent(amperes_per_lamp=1e-6, dark_a=0.0, meter_std_a=5e-14)
    rng = np.random.default_rng(seed)
    readings = [current.measure_a((0.5, 0.5), 0.02, rng) for _ in range(4000)]
    expected = (1.602176634e-19 * 1e-6 + 5e-14**2) / 0.02
    relative_std_error = (2 / len(readings)) ** 0.5
    assert np.var(readings) == pytest.approx(expected, rel=5 * relative_std_error)
    assert np.mean(readings) == pytest.approx(1e-6, abs=5 * (expected / len(readings)) ** 0.5)


def test_cap_does_not_dim_the_monitor(monitor: MockMonitor, world: World) -> None:
    world.drive(0, 1.0)
    world.cap(True)
    assert monitor.read().current_a > 1e-7


def test_overflows_above_its_range(monitor: MockMonitor, world: World) -> None:
    world.drive(0, 1.0)
    monitor.range_a = 2e-8
    with pytest.raises(DeviceError) as caught:
        monitor.read()
    assert caught.value.code == "monitor-overflow"


@pytest.mark.parametrize(
    ("fault", "kind"), [("lost", DeviceLostError), ("silent", DeviceTimeoutError)]
)
def test_cut_line_raises_and_mends(
    monitor: MockMonitor, fault: Fault, kind: type[DeviceError]
) -> None:
    monitor.line.fault = fault
    with pytest.raises(kind):
        monitor.read()
    monitor.line.fault = "none"
    monitor.read()
