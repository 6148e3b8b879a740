"""The simulated camera as a process: it dies with its starter, or lives without one."""

import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from drivers.aravis import gi_aravis
from drivers.aravis.camera import AravisCamera
from drivers.aravis.simulated.description import described
from drivers.aravis.simulated.line_clock import LineClock
from drivers.aravis.simulated_process import SimulatedCameraProcess
from drivers.errors import DeviceError
from drivers.mock.limits import CameraLimits
from drivers.ports import CameraSettings
from tests.contracts.camera import whole
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.drivers.aravis.conftest import opened


def test_line_clock_rows_frames_up_without_gap_or_overlap() -> None:
    clock = LineClock()
    jitter = (0.0, 0.003, -0.002, 0.004, 0.001)
    starts = [clock.next_frame(0.01 * n + j, 100, 100.0) for n, j in enumerate(jitter)]
    assert starts == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])


def test_line_clock_skips_whole_lines_in_a_pause() -> None:
    clock = LineClock()
    clock.next_frame(0.0, 100, 100.0)
    start = clock.next_frame(5.00005, 100, 100.0)
    assert start == pytest.approx(5.00005, abs=100e-6)
    assert start / 100e-6 == pytest.approx(round(start / 100e-6))


def test_line_clock_never_runs_back() -> None:
    clock = LineClock()
    ends = clock.next_frame(1.0, 10, 100.0) + 10 * 100e-6
    assert clock.next_frame(0.0, 10, 100.0) >= ends


@pytest.mark.parametrize("rows", [None, 48])
@pytest.mark.parametrize("columns", [512, 100, 513])
def test_description_is_xml_whose_references_all_exist(columns: int, rows: int | None) -> None:
    root = ET.fromstring(described(CameraLimits(columns, 12, rows)))  # noqa: S314  our own
    names = {node.get("Name") for node in root.iter() if node.get("Name")}
    used = {
        node.text
        for node in root.iter()
        if node.tag.rpartition("}")[2] in {"pValue", "pFeature", "pMax", "pVariable", "pIsLocked"}
    }
    assert used <= names


def test_odd_sensor_offers_no_packed_formats() -> None:
    assert "Mono12p" not in CameraLimits(513, 12).formats
    assert "Mono12p" in CameraLimits(512, 12).formats


_STARTER = """
import sys, time
from pathlib import Path
from drivers.aravis.simulated_process import SimulatedCameraProcess
process = SimulatedCameraProcess(Path(sys.argv[1]), Path(sys.argv[2]), wait_s=float(sys.argv[3]))
print(process.start().pid, flush=True)
time.sleep(600)
"""


def ends_within(pid: int, seconds: float) -> bool:
    deadline_s = time.monotonic() + seconds
    while time.monotonic() < deadline_s:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except FileNotFoundError:
            return True
        if state == "Z":
            return True
        time.sleep(0.05)
    return False


@pytest.mark.aravis
def test_dies_with_its_starter_even_by_kill(model_path: Path, world_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", _STARTER, model_path, world_path, str(ADDRESS_WAIT_S)],
        stdout=subprocess.PIPE,
        text=True,
    ) as starter:
        assert starter.stdout is not None
        pid = int(starter.stdout.readline())
        starter.kill()
        starter.wait()
        assert ends_within(pid, 60.0)


@pytest.mark.aravis
def test_detached_camera_needs_no_starter_and_ends_by_sigterm(
    model_path: Path, world_path: Path
) -> None:
    command = [
        *(
            sys.executable,
            "-m",
            "drivers.aravis.simulated",
            "--detached",
            "--wait",
            str(ADDRESS_WAIT_S),
        ),
        *("--model", model_path, "--world", world_path, "--serial", "D1"),
    ]
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        with opened("127.0.0.1") as camera:
            assert camera.identity.serial == "D1"
        process.send_signal(signal.SIGTERM)
        assert process.wait(60.0) == 0


@pytest.mark.aravis
def test_missing_model_is_one_sentence_on_standard_error(world_path: Path) -> None:
    process = subprocess.run(
        [sys.executable, "-m", "drivers.aravis.simulated", "--model", "nowhere.toml",
         "--world", world_path],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert process.returncode == 1
    assert "nowhere.toml" in process.stderr
    assert len(process.stderr.strip().splitlines()) == 1
    assert process.stdout == ""


def test_opening_without_aravis_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    gi_aravis.aravis.cache_clear()
    monkeypatch.setitem(sys.modules, "gi", None)
    try:
        with pytest.raises(DeviceError) as caught:
            AravisCamera.open("127.0.0.1")
    finally:
        gi_aravis.aravis.cache_clear()
    assert caught.value.code == "aravis-missing"
    assert "apt-get install" in str(caught.value)


@pytest.mark.aravis
def test_a_camera_that_starts_again_does_not_repeat_its_seed(
    tmp_path: Path, world_path: Path, wanted: CameraSettings
) -> None:
    residuals = []
    process = SimulatedCameraProcess("demo", world_path, seed=3, wait_s=ADDRESS_WAIT_S)
    for _ in range(2):
        with process, opened(process.address) as camera:
            assert camera.identity.serial == "D0001"
            camera.configure(wanted)
            dn = np.concatenate([frame.dn for frame in whole(camera.frames(4))]).astype(float)
            residuals.append((dn - dn.mean(axis=0)).ravel())
    # Repeated noise would correlate by 1; 6 standard errors are never seen by chance.
    assert abs(np.corrcoef(*residuals)[0, 1]) < 6 / np.sqrt(residuals[0].size)
