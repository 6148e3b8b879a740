"""Folders and files that this user may not write or read."""

import json
import shutil
from pathlib import Path

import pytest

from tests.test_bad_input.processes import darkflat, rights_that_count
from tests.test_bad_input.running import tree

TO_A_CLOSED_FOLDER = [
    "import rec --out closed/out.h5",
    "simulate demo plan.toml --out closed/out.h5",
    "export rec.h5 --out closed/out",
    "apply set.h5 rec --out closed/out.h5",
    "calibrate rec.h5 --out closed/out.h5",
    "sweep plan.toml --bench bench.toml --out closed/out.h5",
    "sweep plan.toml --dry-run --json closed/answer.json",
]
FROM_A_CLOSED_FILE = {
    "rec/frames/001.npy": "import rec --out out.h5",
    "rec/conditions.csv": "import rec --out out.h5",
    "rec.h5": "export rec.h5 --out out",
    "rec.frames.jsonl": "export rec.h5 --out out",
    "set.h5": "apply set.h5 rec --out out.h5",
    "plan.toml": "sweep plan.toml --dry-run",
    "model.toml": "simulate model.toml plan.toml --out out.h5",
    "bench.toml": "sweep plan.toml --bench bench.toml --out out.h5",
}


@pytest.fixture
def work(sound: Path, tmp_path: Path) -> Path:
    return shutil.copytree(sound, tmp_path / "work")


@pytest.mark.parametrize("command", TO_A_CLOSED_FOLDER)
def test_an_output_folder_that_is_not_writable(work: Path, command: str) -> None:
    (work / "closed").mkdir(mode=0o555)
    before = tree(work)
    ran = darkflat(work, *command.split(), within=rights_that_count())
    assert ran.returncode == 1
    assert len(ran.stderr.splitlines()) == 1
    assert "closed" in ran.stderr
    assert tree(work) == before


@pytest.mark.parametrize(("name", "command"), FROM_A_CLOSED_FILE.items())
def test_an_input_that_may_not_be_read(work: Path, name: str, command: str) -> None:
    before = tree(work)
    (work / name).chmod(0)
    ran = darkflat(work, *command.split(), "--json", "-", within=rights_that_count())
    (work / name).chmod(0o600)
    assert ran.returncode == 1
    assert json.loads(ran.stdout)["error"]["code"] != "internal-error"
    assert len(ran.stderr.splitlines()) == 1
    assert Path(name).name in ran.stderr
    assert tree(work) == before
