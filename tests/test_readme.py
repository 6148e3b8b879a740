"""What the README says, works: its commands and its Python are run as they stand, in order."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.contracts.simulated_camera import ADDRESS_WAIT_S

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")

PLAN = """
name = "readme"
lines = 64
frame_lines = 32
darks = "before"
[sweep]
type = "factorial"
exposures_us = [30.0, 60.0, 90.0]
levels = [1, 2]
[camera]
line_period_us = 100.0
[settle]
tolerance_percent = 1.0
stable_for_s = 0.5
[source]
radiance = { 1 = 10.2, 2 = 20.1 }
"""


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


@pytest.mark.aravis
def test_its_commands_and_its_python_run_as_they_stand(tmp_path: Path) -> None:
    bench = (ROOT / "examples" / "benches" / "simulated.toml").read_text("utf-8")
    assert 'id = "simulated"' in bench  # others may use that one, or be at its camera's address
    bench = bench.replace('id = "simulated"', f'id = "readme-{os.getpid()}"')
    (tmp_path / "bench.toml").write_text(f"{bench}\ncamera_wait_s = {ADDRESS_WAIT_S}\n", "utf-8")
    (tmp_path / "plan.toml").write_text(PLAN)
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "DARKFLAT_HOME": str(tmp_path / "home")}
    commands = [line[2:] for block in blocks("console") for line in block.splitlines()]
    assert len(commands) >= 10
    for command in commands:
        done = subprocess.run(
            shlex.split(command), cwd=tmp_path, env=environment, capture_output=True, text=True,
            check=False, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    for code in blocks("python"):
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, check=True)


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", *sorted(
    str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md")
)])  # fmt: skip
def test_every_file_that_a_page_points_to_is_there(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    targets = re.findall(r"\]\((?!https?:|#)([^)#]+)", text)
    missing = [t for t in targets if not ((ROOT / page).parent / t).exists()]
    assert missing == []


@pytest.mark.parametrize("target", ["demo", "test", "bench", "check", "soak", "serve"])
def test_make_knows_what_the_pages_name(target: str) -> None:
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(), re.MULTILINE)
