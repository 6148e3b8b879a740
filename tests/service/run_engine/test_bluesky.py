"""Bluesky's own RunEngine moves and reads an open bench, and leaves it dark."""

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from drivers.ports import CameraSettings
from service.bench import Bench, open_bench
from service.bluesky import BenchDevices, devices_of
from tests.service.sequencer.benches import assert_dark, in_process

pytest.importorskip("bluesky", reason="Bluesky is not there: pip install darkflat[bluesky]")

from bluesky import protocols
from bluesky.plan_stubs import abs_set, mv, wait
from bluesky.plans import count, scan
from bluesky.run_engine import RunEngine
from bluesky.utils import FailedStatus

SETTINGS = CameraSettings(
    exposure_us=50.0, line_period_us=1000.0, frame_lines=32, n_columns=64, pixel_format="Mono12"
)
Documents = list[tuple[str, dict[str, Any]]]


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    with open_bench(in_process(f"bluesky-{os.getpid()}")) as opened:
        yield opened


@pytest.fixture
def devices(bench: Bench) -> BenchDevices:
    return devices_of(bench, SETTINGS)


@pytest.fixture(scope="module")
def engine() -> RunEngine:
    return RunEngine({}, context_managers=[])


def documents_of(engine: RunEngine, plan: Any) -> Documents:
    documents: Documents = []
    engine(plan, lambda name, document: documents.append((name, document)))
    return documents


def events(documents: Documents) -> list[dict[str, Any]]:
    return [document["data"] for name, document in documents if name == "event"]


def test_devices_are_what_bluesky_calls_so(devices: BenchDevices) -> None:
    light, camera, shutter, monitor = (
        devices.light, devices.camera, devices.shutter, devices.monitor,
    )  # fmt: skip
    for device in (light, camera, shutter, monitor):
        assert isinstance(device, protocols.Readable)
        assert isinstance(device, protocols.HasParent)
    assert isinstance(light, protocols.Locatable)
    assert isinstance(light, protocols.Stoppable)
    assert isinstance(shutter, protocols.Movable)
    assert isinstance(camera, protocols.Configurable)
    for device in (camera, monitor):
        assert isinstance(device, protocols.Triggerable)
    for device in (light, camera):
        assert isinstance(device, protocols.Stageable)


def test_a_scan_sees_more_light_with_each_level_and_ends_dark(
    engine: RunEngine, devices: BenchDevices, bench: Bench
) -> None:
    devices.camera.frames = 4
    scanned = scan([devices.camera, devices.monitor], devices.light, 0, 3, 4)
    data = events(documents_of(engine, scanned))
    assert [each["light"] for each in data] == [0.0, 1.0, 2.0, 3.0]
    dn = np.array([each["camera_mean_dn"] for each in data])
    assert (np.diff(dn) > 0).all()
    assert [each["camera_mean_line_dn"].shape for each in data] == [(64,)] * 4
    assert all(each["camera_mean_line_dn"].mean() == each["camera_mean_dn"] for each in data)
    assert [each["camera_lost_frames"] for each in data] == [0] * 4
    monitor = np.array([each["monitor_current"] for each in data])
    assert (np.diff(monitor) > 0).all()
    assert bench.world is not None
    assert_dark(bench.world)


def test_a_cap_takes_the_light_away(engine: RunEngine, devices: BenchDevices) -> None:
    taken = {}
    for capped in (False, True):
        engine(mv(devices.light, 3, devices.shutter, capped))
        (taken[capped],) = events(documents_of(engine, count([devices.camera, devices.shutter])))
        assert taken[capped]["capped"] is capped
    engine(mv(devices.shutter, False))
    devices.light.unstage()
    assert taken[True]["camera_mean_dn"] < taken[False]["camera_mean_dn"]


def test_settings_are_in_the_descriptor_as_read_back(
    engine: RunEngine, devices: BenchDevices
) -> None:
    documents = documents_of(engine, count([devices.camera]))
    (descriptor,) = (each for name, each in documents if name == "descriptor")
    settings = descriptor["configuration"]["camera"]["data"]
    assert settings["camera_line_period_us"] == pytest.approx(1000.0, rel=0.01)
    assert descriptor["data_keys"]["camera_mean_line_dn"]["shape"] == [64]


def test_a_level_that_the_light_has_not_fails_the_plan_and_leaves_it_dark(
    engine: RunEngine, devices: BenchDevices, bench: Bench
) -> None:
    with pytest.raises(FailedStatus) as failed:
        engine(scan([devices.camera], devices.light, 2, 99, 2))
    assert "99" in str(failed.value.__cause__ or failed.value)
    assert bench.world is not None
    assert_dark(bench.world)


def test_a_plan_that_breaks_while_the_lamps_are_set_leaves_them_off(
    engine: RunEngine, devices: BenchDevices, bench: Bench
) -> None:
    def breaks() -> Any:
        yield from abs_set(devices.light, 3, group="light")
        yield from wait("light")
        assert devices.light.locate() == {"setpoint": 3.0, "readback": 3.0}
        yield from abs_set(devices.light, 1)
        raise RuntimeError("the plan has a defect")

    with pytest.raises(RuntimeError, match="a defect"):
        engine(breaks())
    assert devices.light.locate() == {"setpoint": 0.0, "readback": 0.0}
    assert bench.world is not None
    assert_dark(bench.world)
