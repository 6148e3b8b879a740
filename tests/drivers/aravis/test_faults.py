"""Each fault that users of Aravis meet, injected over loopback, ends in a clear error."""

import time
from dataclasses import replace
from itertools import dropwhile
from pathlib import Path

import pytest

from drivers.aravis import frame_stream
from drivers.aravis.camera import AravisCamera
from drivers.aravis.gi_aravis import connect, new_buffer
from drivers.aravis.simulated.address_lock import held
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.aravis.stream_report import StreamReport
from drivers.errors import (
    DeviceBusyError,
    DeviceError,
    DeviceLostError,
    DeviceNotFoundError,
    DeviceTimeoutError,
    SettingRefusedError,
)
from drivers.mock.world import World
from drivers.ports import CameraSettings, CapturedFrame, LostFrame
from tests.contracts.camera import whole
from tests.contracts.simulated_camera import assert_mean, expected_dn, lit
from tests.drivers.aravis.conftest import opened

__all__ = ["lit"]

pytestmark = pytest.mark.aravis


@pytest.mark.parametrize(
    ("address", "hint"),
    [
        ("10.255.255.1", "no interface of this machine is in its subnet"),
        ("127.0.0.3", "firewall"),
        ("darkflat-NOBODY", "firewall"),
        ("C1", "Vendor-Serial"),
    ],
)
def test_no_camera_says_where_it_was_looked_for_and_what_was_found(
    process: SimulatedCameraProcess, address: str, hint: str
) -> None:
    with pytest.raises(DeviceNotFoundError) as caught:
        AravisCamera.open(address)
    assert caught.value.code == "device-not-found"
    assert address in str(caught.value)
    assert hint in str(caught.value)
    assert "darkflat-C1 at 127.0.0.1" in str(caught.value) or "C1 at 127.0.0.1" in str(caught.value)


def test_opens_by_vendor_and_serial(process: SimulatedCameraProcess) -> None:
    with opened("darkflat-C1") as camera:
        assert camera.identity.serial == "C1"


def test_a_camera_that_another_controls_is_busy_and_undisturbed(
    camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    with pytest.raises(DeviceBusyError) as caught:
        AravisCamera.open("127.0.0.1")
    assert caught.value.code == "device-busy"
    assert len(whole(camera.frames(2))) == 2


def test_control_is_free_at_once_after_close(process: SimulatedCameraProcess) -> None:
    for _ in range(3):
        with opened(process.address) as camera:
            assert camera.identity.serial == "C1"


@pytest.mark.parametrize(
    ("change", "code", "names"),
    [
        ({"exposure_us": 101.0}, "setting-out-of-range", ("ExposureTime", "101", "100")),
        ({"n_columns": 513}, "setting-out-of-range", ("Width", "513", "512")),
        ({"n_columns": 500}, "setting-off-step", ("Width", "500", "step of 8")),
        ({"first_column": 8}, "setting-out-of-range", ("OffsetX", "8", "0")),
        ({"n_columns": 256, "first_column": 4}, "setting-off-step", ("OffsetX", "step of 8")),
        ({"frame_lines": 70000}, "setting-out-of-range", ("Height", "65535")),
        ({"gain_db": 25.0}, "setting-out-of-range", ("Gain", "24")),
        ({"black_level_dn": -1.0}, "setting-out-of-range", ("BlackLevel", "-1")),
        ({"pixel_format": "RGB8"}, "setting-unknown", ("PixelFormat", "RGB8", "Mono12p")),
    ],
)
def test_refused_setting_names_feature_and_values(
    camera: AravisCamera,
    wanted: CameraSettings,
    change: dict[str, float],
    code: str,
    names: tuple[str, ...],
) -> None:
    with pytest.raises(SettingRefusedError) as caught:
        camera.configure(replace(wanted, **change))  # type: ignore[arg-type]
    assert caught.value.code == code
    assert all(name in str(caught.value) for name in names), str(caught.value)


def test_read_only_feature_says_so(camera: AravisCamera) -> None:
    with pytest.raises(SettingRefusedError) as caught:
        camera._held().features.write_number("DeviceTemperature", 25.0)
    assert caught.value.code == "feature-read-only"
    assert "DeviceTemperature" in str(caught.value)


def test_unknown_feature_names_all_that_were_tried(camera: AravisCamera) -> None:
    with pytest.raises(SettingRefusedError) as caught:
        camera._held().features.required(("Colour", "Color"))
    assert caught.value.code == "feature-unknown"
    assert "Colour, Color" in str(caught.value)


def impatient(camera: AravisCamera) -> None:
    """Wait no longer for a frame that will not come; for those that do, a busy machine may."""
    acquisition = camera._acquisition
    assert acquisition is not None
    acquisition.patience_s, acquisition._give_up_s = 0.2, 0.0


def test_killed_camera_is_lost_and_found_again_after_its_restart(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    with opened(process.address) as camera:
        camera.configure(wanted)
        frames = camera.frames(100_000)
        next(frames)
        process.kill()
        impatient(camera)
        with pytest.raises(DeviceLostError) as caught:
            list(frames)
        assert caught.value.code == "control-lost"
        with pytest.raises(DeviceLostError):
            next(camera.frames(1))
        with pytest.raises(DeviceNotFoundError):
            camera.configure(wanted)
        process.start()
        camera.configure(wanted)
        assert len(whole(camera.frames(3))) == 3


def test_camera_that_hangs_is_lost(process: SimulatedCameraProcess, wanted: CameraSettings) -> None:
    with opened(process.address) as camera:
        camera.configure(wanted)
        frames = camera.frames(100_000)
        next(frames)
        process.hang()
        impatient(camera)
        with pytest.raises(DeviceLostError):
            list(frames)
        process.wake()


def test_camera_that_another_program_takes_over_is_lost_and_says_so(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    with opened(process.address) as camera:
        camera.configure(wanted)
        frames = camera.frames(100_000)
        next(frames)
        # As when a pause, a debugger's say, lets the heartbeat run out: control is free meanwhile.
        camera._held().camera.get_device().leave_control()
        with opened(process.address) as other:
            impatient(camera)
            with pytest.raises(DeviceLostError, match="another program took control") as caught:
                list(frames)
            assert caught.value.code == "control-lost"
            other.configure(wanted)
            assert len(whole(other.frames(2))) == 2
        camera.configure(wanted)
        assert len(whole(camera.frames(2))) == 2


def test_camera_that_sends_nothing_times_out_and_recovers(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    with opened(process.address) as camera:
        camera.configure(wanted)
        process.stall(after_frames=3)
        frames = camera.frames(100)
        assert len([next(frames) for _ in range(3)]) == 3
        impatient(camera)
        with pytest.raises(DeviceTimeoutError) as caught:
            next(frames)
        assert caught.value.code == "frame-timeout"
        assert "firewall" in str(caught.value)
        process.resume()
        assert len(whole(camera.frames(3))) == 3


def test_lost_packets_lose_frames_that_are_named_and_taken_again(
    process: SimulatedCameraProcess, camera: AravisCamera, lit: World, wanted: CameraSettings
) -> None:
    used = camera.configure(replace(wanted, frame_lines=128))
    process.lose_packets(0.012)  # some 14 of the frames: neither none nor too many of them
    arrived = list(camera.frames(100))
    lost = [frame for frame in arrived if isinstance(frame, LostFrame)]
    frames = [frame for frame in arrived if isinstance(frame, CapturedFrame)]
    assert len(frames) == 100
    assert lost
    assert all(frame.reason for frame in lost)
    assert camera.stream_report.missing_packets > 0
    expected = expected_dn(used, (1, 1, 1))
    for frame in frames:  # nothing was padded with zeros
        assert_mean(frame.dn.astype(float), expected, sigmas=7.0)


def test_every_frame_is_accounted_for_even_when_its_leader_is_lost(
    process: SimulatedCameraProcess, camera: AravisCamera, wanted: CameraSettings
) -> None:
    # Few packets, and the leader is one of three: some 17 frames lose theirs, some 50 are lost.
    camera.configure(replace(wanted, frame_lines=8, line_period_us=500.0))
    process.lose_packets(0.07)
    arrived = list(camera.frames(200))
    # What is lost before the first whole frame has no number yet.
    ids = list(dropwhile(lambda number: number is None, (frame.frame_id for frame in arrived)))
    assert any("leader" in frame.reason for frame in arrived if isinstance(frame, LostFrame))
    first, last = ids[0], ids[-1]
    assert first is not None
    assert last is not None
    assert len(ids) == (last - first) % 65535 + 1
    assert len(set(ids)) == len(ids)


def test_a_link_that_loses_most_frames_is_an_error(
    process: SimulatedCameraProcess, camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    process.lose_packets(0.6)
    with pytest.raises(DeviceError) as caught:
        list(camera.frames(20))
    assert caught.value.code == "frames-lost"
    assert "packets missing" in str(caught.value)


def test_truncated_frames_are_lost_although_aravis_calls_them_a_success(
    camera: AravisCamera, wanted: CameraSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    camera.configure(wanted)
    monkeypatch.setattr(frame_stream, "new_buffer", lambda size: new_buffer(size - 1000))
    arrived = camera.frames(3)
    first = next(arrived)
    arrived.close()  # type: ignore[attr-defined]
    assert isinstance(first, LostFrame)


def test_a_slow_consumer_loses_frames_as_underruns_not_as_packets(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    for _ in range(5):  # a machine too busy to receive loses packets as well, but not every time
        reasons, report = lost_by_a_slow_consumer(process, wanted)
        if report.missing_packets == 0:
            break
    assert len(reasons) >= 3
    assert all("underrun" in reason for reason in reasons)
    assert report.underruns >= len(reasons)
    assert report.missing_packets == 0


def lost_by_a_slow_consumer(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> tuple[list[str], StreamReport]:
    with opened(process.address, n_buffers=2) as camera:
        camera.configure(wanted)
        reasons: list[str] = []
        # Of so many that no number of lost ones ends it before.
        for frame in camera.frames(100_000, lambda: len(reasons) >= 3):
            if isinstance(frame, LostFrame):
                reasons.append(frame.reason)
            else:
                time.sleep(0.03)
        return reasons, camera.stream_report


def test_a_consumer_that_sleeps_for_less_than_a_second_loses_nothing(
    camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    arrived = []
    for frame in camera.frames(80):  # of 6.4 ms each
        arrived.append(frame)
        if len(arrived) == 1:
            time.sleep(0.5)
    assert not [frame for frame in arrived if isinstance(frame, LostFrame)]


def test_packet_size_is_left_to_the_link_where_none_is_given(
    camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    camera._held().default_packet_size = None
    assert len(whole(camera.frames(3))) == 3


@pytest.mark.parametrize("packet_size", [1400, 8192, 60000])
def test_packet_size_that_is_given_is_used(
    process: SimulatedCameraProcess, wanted: CameraSettings, packet_size: int
) -> None:
    with opened(process.address, packet_size=packet_size) as camera:
        camera.configure(wanted)
        assert len(whole(camera.frames(2))) == 2
        assert camera.features()["GevSCPSPacketSize"] == str(packet_size)


def test_what_a_dead_client_left_behind_is_taken_back(
    process: SimulatedCameraProcess, wanted: CameraSettings
) -> None:
    left = connect(process.address)
    left.set_string("TriggerMode", "On")
    left.set_integer("GevHeartbeatTimeout", 3000)
    left.set_integer("TLParamsLocked", 1)
    left.start_acquisition()
    left.get_device().leave_control()
    del left
    with opened(process.address) as camera:
        camera.configure(replace(wanted, frame_lines=32))
        assert len(whole(camera.frames(3))) == 3
        assert camera.features()["TriggerMode"] == "Off"


def test_image_format_is_locked_only_while_frames_are_taken(
    camera: AravisCamera, wanted: CameraSettings
) -> None:
    camera.configure(wanted)
    frames = camera.frames(1000)
    next(frames)
    assert camera.features()["TLParamsLocked"] == "1"
    frames.close()  # type: ignore[attr-defined]
    assert camera.features()["TLParamsLocked"] == "0"


def test_second_simulated_camera_at_an_address_says_that_it_is_taken(
    process: SimulatedCameraProcess, model_path: Path, world_path: Path
) -> None:
    with pytest.raises(DeviceError) as caught:
        SimulatedCameraProcess(model_path, world_path, interface=process.address).start()
    assert caught.value.code == "simulated-camera-failed"
    assert "taken" in str(caught.value)


def test_nobody_gets_the_address_of_a_camera_that_was_killed_before_it_is_stopped(
    process: SimulatedCameraProcess,
) -> None:
    """Others would answer in its stead, as nothing does where a camera was unplugged."""
    process.kill()
    with pytest.raises(DeviceBusyError, match="taken"), held(process.address, wait_s=0.0):
        pass


def test_simulated_camera_at_an_address_that_is_not_ours_says_so(
    model_path: Path, world_path: Path
) -> None:
    with pytest.raises(DeviceError) as caught:
        SimulatedCameraProcess(model_path, world_path, interface="127.0.0.77").start()
    assert "no network interface" in str(caught.value)
