"""The emulators' process: it survives its clients, and nothing survives its parent."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from drivers.errors import DeviceLostError
from drivers.mock.emulators.process import EmulatorProcess
from drivers.mock.world import World
from drivers.serial.gen import GenLamps
from drivers.serial.gen_lamp import LampRating

_RATING = LampRating(4.0, 26.0, ramp_step_a=2.0, ramp_step_s=0.0)
_BURN_AND_WAIT = """
import sys, time
from drivers.serial.gen import GenLamps
from drivers.serial.gen_lamp import LampRating
rating = LampRating(4.0, 26.0, ramp_step_a=4.0, ramp_step_s=0.0)
lamps = GenLamps.open(sys.argv[1], addresses=[1, 2], rating=rating)
lamps.set_level(2)
print("burning", flush=True)
while True:
    lamps.state()
"""


@pytest.fixture
def emulators(tmp_path: Path) -> Iterator[EmulatorProcess]:
    with EmulatorProcess(tmp_path / "world", lamps=2) as process:
        yield process


def _open(emulators: EmulatorProcess) -> GenLamps:
    port = emulators.ports["lamps"]
    assert port is not None
    return GenLamps.open(port, addresses=[1, 2], rating=_RATING)


def test_lamps_of_another_process_light_the_world(
    emulators: EmulatorProcess, tmp_path: Path
) -> None:
    lamps = _open(emulators)
    lamps.set_level(1)
    world = World(tmp_path / "world")
    assert world.state().emissions(time.monotonic() + 10) == pytest.approx((1.0, 0.0))
    lamps.close()


def test_killed_client_leaves_lamps_burning_that_the_next_one_finds_and_puts_off(
    emulators: EmulatorProcess, tmp_path: Path
) -> None:
    command = [sys.executable, "-c", _BURN_AND_WAIT, str(emulators.ports["lamps"])]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as client:
        assert client.stdout is not None
        assert client.stdout.readline() == "burning\n"
        client.kill()
    lamps = _open(emulators)
    assert lamps.state().level == 2
    assert lamps.off().level == 0
    lamps.close()


def test_faults_come_over_the_control_line(emulators: EmulatorProcess) -> None:
    lamps = _open(emulators)
    emulators.inject("lamps vanish")
    with pytest.raises(DeviceLostError):
        lamps.state()
    emulators.inject("lamps return")
    assert lamps.off().level == 0
    lamps.close()
    with pytest.raises(ValueError, match="no fault"):
        emulators.inject("lamps explode")


def test_only_what_is_there_has_a_port(emulators: EmulatorProcess) -> None:
    assert emulators.ports["led"] is None
    assert set(emulators.ports) == {"lamps", "led", "monitor", "shutter"}


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["TERM", "INT"])
def test_ends_when_told_to_and_takes_its_ports_along(tmp_path: Path, number: int) -> None:
    process, ports = _started(tmp_path, sys.executable)
    process.send_signal(number)
    assert process.wait(60) == 0
    assert not any(Path(port).exists() for port in ports.values() if port)


def _started(tmp_path: Path, *command: str) -> tuple[subprocess.Popen[str], dict[str, str | None]]:
    arguments = ["-m", "drivers.mock.emulators", "--world", str(tmp_path / "w"), "--lamps", "1"]
    process = subprocess.Popen(
        [*command, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    with process.stdout as said:
        return process, json.loads(said.readline())


def test_ends_with_its_parent_even_if_that_is_killed(tmp_path: Path) -> None:
    parent = (
        "import subprocess, sys, time;"
        "child = subprocess.Popen([sys.executable, *sys.argv[1:]]);"
        "print(child.pid, file=sys.stderr, flush=True);"
        "time.sleep(100)"
    )
    arguments = ["-m", "drivers.mock.emulators", "--world", str(tmp_path / "w"), "--lamps", "1"]
    with subprocess.Popen(
        [sys.executable, "-c", parent, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        child = int(process.stderr.readline())
        assert json.loads(process.stdout.readline())
        process.kill()
    for _ in range(6000):
        if not _runs(child):
            return
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    pytest.fail("the emulators outlived their parent")


def _runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"
