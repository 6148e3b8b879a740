"""What docs/service.md says of a calibration by `curl` and from Python, works as it stands."""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import tomli_w

from calib.recording.commit_log import commit_path
from calib.recording.open import open_recording
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.sequencer.benches import SETTLES, in_process

__all__ = ["plan_file", "recording_file"]

ROOT = Path(__file__).parents[3]
SECTIONS = ("A whole calibration from a control PC", "Jobs")


def blocks(language: str) -> list[str]:
    page = (ROOT / "docs" / "service.md").read_text("utf-8")
    by_title = dict(each.split("\n", 1) for each in re.split(r"^## ", page, flags=re.MULTILINE)[1:])
    text = "".join(by_title[title] for title in SECTIONS)
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def a_free_port() -> str:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return str(listening.getsockname()[1])


def prepare(folder: Path, recording: Path) -> None:
    """Write every file that the page takes to be there."""
    bench = in_process(f"page-{os.getpid()}").model_dump(mode="json", exclude_none=True)
    (folder / "bench.toml").write_text(tomli_w.dumps(bench))
    plan = json.loads(blocks("json")[0]) | {"settle": SETTLES}  # this bench's lamps are quick
    (folder / "plan.json").write_text(json.dumps(plan))
    lines = np.random.default_rng().integers(500, 2000, (8, 1024), dtype=np.uint16)
    np.save(folder / "lines.npy", lines)
    kept = folder / "recording.h5"
    shutil.copy(recording, kept)
    shutil.copy(commit_path(recording), commit_path(kept))


def test_a_calibration_by_curl_and_from_python(tmp_path: Path, recording_file: Path) -> None:
    prepare(tmp_path, recording_file)
    port = a_free_port()
    commands = [line[2:] for block in blocks("console") for line in block.splitlines()]
    assert len(commands) >= 20
    python = blocks("python")
    assert len(python) == len(SECTIONS)
    (tmp_path / "story.py").write_text("\n".join(python).replace("8642", port))
    serve = commands.pop(0)
    assert serve == "darkflat serve --bench bench.toml &"
    script = ["set -euo pipefail", f"{serve[:-1]} --port {port} &", "trap 'kill %1; wait' EXIT"]
    script += [each.replace("8642", port) for each in commands]
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "DARKFLAT_HOME": str(tmp_path / "home")}
    environment["PYTHONPATH"] = str(ROOT)
    done = subprocess.run(
        ["bash", "-c", "\n".join([*script, f"{sys.executable} story.py"])],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    said = done.stdout.splitlines()
    for answer in ("succeeded", "verified", "certified", "cancelled", "True"):
        assert answer in said
    assert "<svg" in (tmp_path / "data-sheet.html").read_text("utf-8")
    assert (tmp_path / "report.html").exists()
    with zipfile.ZipFile(tmp_path / "elsewhere.zip") as archive:
        stem = open_recording(recording_file).digest()[:12]
        assert set(archive.namelist()) == {f"{stem}.h5", f"{stem}.frames.jsonl"}
    with zipfile.ZipFile(tmp_path / "radiance.npz") as archive:
        assert set(archive.namelist()) == {
            "notes.json", "radiance.npy", "std.npy", "flags.npy",
        }  # fmt: skip
