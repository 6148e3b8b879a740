"""No room left, for real: the command ends in one sentence, and only what can go on is left.

A limit on the length of files stands in for a full disk everywhere; where this process may mount
one, a small file system that is really full is taken as well.
"""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from calib.recording.open import open_recording
from tests.test_bad_input.processes import DARKFLAT, as_a_process, darkflat, no_file_longer_than
from tests.test_bad_input.running import tree

MOUNT = "mount -t tmpfs -o size=64k none disk"
WHOLE_OR_NOT_AT_ALL = [
    ("import rec --out out.h5", 1_000),
    ("import rec --out out.h5", 60_000),
    ("simulate demo plan.toml --out out.h5", 20_000),
    ("simulate demo plan.toml --out folder", 20_000),
    ("export rec.h5 --out folder", 8_300),
    ("apply set.h5 rec --out out.h5", 1_000),
    ("apply set.h5 rec --out out.h5", 300_000),
    ("calibrate rec.h5 --out out.h5", 1_000),
    ("calibrate rec.h5 --out out.h5", 10_000),
    ("sweep plan.toml --bench bench.toml --out out.h5", 5_000),
]
ON_A_FULL_DISK = [
    "import ../rec --out out.h5",
    "export ../rec.h5 --out folder",
    "apply ../set.h5 ../rec --out out.h5",
]


def may_mount() -> bool:
    try:
        return not subprocess.run(["unshare", "-rm", "true"], capture_output=True).returncode  # noqa: PLW1510
    except OSError:
        return False


@pytest.fixture(scope="module")
def compiled(sound: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Have the compiled loops in their cache, which needs room too."""
    work = shutil.copytree(sound, tmp_path_factory.mktemp("compiled") / "work")
    assert darkflat(work, "apply", "set.h5", "rec", "--out", "out.h5").returncode == 0


@pytest.fixture
def work(compiled: None, sound: Path, tmp_path: Path) -> Path:
    return shutil.copytree(sound, tmp_path / "work")


@pytest.mark.parametrize(("command", "room"), WHOLE_OR_NOT_AT_ALL)
def test_a_full_disk_is_one_sentence_and_nothing_is_left(
    work: Path, command: str, room: int
) -> None:
    before = tree(work.parent)
    ran = darkflat(work, *command.split(), "--json", "-", within=no_file_longer_than(room))
    assert ran.returncode == 1, ran.stderr
    error = json.loads(ran.stdout)["error"]
    assert error["code"] == "disk-full"
    assert ran.stderr == f"darkflat: {error['message']}\n"
    assert "free some" in error["message"]
    assert tree(work.parent) == before


def test_a_sweep_that_fills_the_disk_keeps_its_blocks_and_goes_on(work: Path) -> None:
    sweep = ("sweep", "plan.toml", "--bench", "bench.toml", "--out", "out.h5", "--json", "-")
    ran = darkflat(work, *sweep, within=no_file_longer_than(1_100_000))
    assert ran.returncode == 1
    assert json.loads(ran.stdout)["error"]["code"] == "disk-full"
    assert len(ran.stderr.splitlines()) == 1
    kept = open_recording(work / "out.h5").header.blocks
    assert 0 < len(kept) < 9
    assert darkflat(work, *sweep, "--resume").returncode == 0
    assert open_recording(work / "out.h5").header.blocks[: len(kept)] == kept


@pytest.mark.parametrize("command", ON_A_FULL_DISK if may_mount() else [])
def test_a_file_system_without_room_is_one_sentence_and_stays_empty(
    work: Path, command: str
) -> None:
    (work / "disk").mkdir()
    told = f"{DARKFLAT} {command} --json -; echo $? $(ls -A) > ../told"
    script = f"{MOUNT} && cd disk && {{ {told}; }}"
    ran = subprocess.run(
        ["unshare", "-rm", "sh", "-c", script],
        cwd=work,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "DARKFLAT_HOME": str(work)},
    )
    assert (work / "told").read_text() == "1\n"
    error = json.loads(ran.stdout)["error"]
    assert error["code"] == "disk-full"
    *progress, said = ran.stderr.splitlines()
    assert said == f"darkflat: {error['message']}"
    assert all(re.match(r"[A-Z]\w+: \d+%; ", line) for line in progress)  # of a busy machine


@pytest.mark.parametrize(
    "command", ["sweep plan.toml --dry-run", "sweep plan.toml --dry-run --json -", "--help"]
)
def test_standard_output_that_takes_nothing_is_one_sentence(work: Path, command: str) -> None:
    with Path("/dev/full").open("w") as full:
        ran = as_a_process(work, *command.split(), stdout=full.fileno())
    assert ran.returncode == 1
    assert len(ran.stderr.splitlines()) == 1
    assert "standard output" in ran.stderr
