"""The first thing that `darkflat serve` does: what it sends, to whom, and how little it imports."""

import os
import select
import subprocess
import sys
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest
import tomli_w

from drivers.serial.port import PortSettings, SerialPort
from service.cli.simulated_bench import chosen_bench
from service.first_off import lamps_off_first

HEAVY = {"numpy", "pydantic", "typer", "fastapi", "h5py", "sqlalchemy", "multiprocessing"}
GROUP_OFF = b"\rGOUT OFF\r"


class FarEnd:
    """The other end of a line."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)

    def heard(self) -> bytes:
        return os.read(self.master, 99) if select.select([self.master], [], [], 0.0)[0] else b""

    def close(self) -> None:
        os.close(self.master)
        os.close(self.slave)


@pytest.fixture
def line() -> Iterator[FarEnd]:
    far_end = FarEnd()
    yield far_end
    far_end.close()


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DARKFLAT_BENCH", raising=False)


def bench(path: Path, port: str, **light: object) -> Path:
    content = {
        "camera": {"driver": "aravis", "address": "x"},
        "light": {"driver": "gen", "port": port, "addresses": [1], **light},
    }
    path.write_text(tomli_w.dumps(content))
    return path


NAMED = {
    "beside": (["serve"], "", "bench.toml"),
    "environment": (["serve"], "a.toml", "a.toml"),
    "option": (["serve", "--port", "0", "--bench", "a.toml"], "b.toml", "a.toml"),
    "option with =": (["serve", "--bench=a.toml"], "b.toml", "a.toml"),
    "last of two": (["serve", "--bench", "b.toml", "--bench", "a.toml"], "", "a.toml"),
}
"""Arguments, DARKFLAT_BENCH, and the file that they mean."""


@pytest.mark.parametrize("named", NAMED)
def test_the_lamps_of_the_bench_that_is_served_are_told_to_go_off(
    line: FarEnd, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str
) -> None:
    arguments, environment, meant = NAMED[named]
    for name in ("bench.toml", "b.toml"):
        bench(tmp_path / name, "/dev/there-is-no-such-port")
    bench(tmp_path / meant, line.port)
    if environment:
        monkeypatch.setenv("DARKFLAT_BENCH", environment)
    option = Path(meant) if any("--bench" in each for each in arguments) else None
    assert chosen_bench(option).settings.light.model_dump()["port"] == line.port
    lamps_off_first(arguments)
    assert line.heard() == GROUP_OFF


def test_an_led_is_told_by_its_channel(line: FarEnd, tmp_path: Path) -> None:
    light = f'[light]\ndriver = "mightex"\nport = "{line.port}"\nchannel = 2\nbaudrate = 19200\n'
    (tmp_path / "bench.toml").write_text(light)
    lamps_off_first(["serve"])
    assert line.heard() == b"\n\rMODE 2 0\n\r"


@pytest.mark.parametrize("arguments", [[], ["sweep", "plan.toml"], ["serve", "--help"]])
def test_who_does_not_serve_switches_nothing_off(
    line: FarEnd, tmp_path: Path, arguments: list[str]
) -> None:
    bench(tmp_path / "bench.toml", line.port)
    lamps_off_first(arguments)
    assert line.heard() == b""


def test_a_line_that_somebody_holds_is_left_to_them(line: FarEnd, tmp_path: Path) -> None:
    bench(tmp_path / "bench.toml", line.port)
    holder = SerialPort(PortSettings(line.port, "holder", 9600))
    lamps_off_first(["serve"])
    assert line.heard() == b""
    holder.close()
    lamps_off_first(["serve"])
    assert line.heard() == GROUP_OFF


@pytest.mark.parametrize(
    "text",
    [
        "", "[light", "light = 3", '[light]\ndriver = "gen"',
        '[light]\ndriver = "mock"\nport = "x"',
        '[light]\ndriver = "gen"\nport = "/dev/null"', '[light]\ndriver = "gen"\nport = 3',
        '[light]\ndriver = "gen"\nport = "/dev/tty-none"\nbaudrate = "fast"',
        '[light]\ndriver = "mightex"\nport = "x"\nchannel = "one"',
    ],
)  # fmt: skip
def test_what_is_wrong_is_left_to_be_said_by_who_opens_the_bench(tmp_path: Path, text: str) -> None:
    (tmp_path / "bench.toml").write_text(text)
    lamps_off_first(["serve"])


def test_nothing_that_takes_long_is_imported_before() -> None:
    program = "import sys, service.cli; print(*sys.modules)"
    root = Path(__file__).parents[2]
    ran = subprocess.run(
        [sys.executable, "-c", program], check=True, cwd=root, stdout=subprocess.PIPE, text=True
    )
    imported = set(ran.stdout.split())
    assert "service.first_off" in imported
    assert not imported & HEAVY
