"""Exit status, standard output and standard error, as other people's scripts see them."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from service.cli.answering import answering
from tests.service.cli.answers import Ran

Run = Callable[..., Ran]
DARKFLAT = (sys.executable, "-c", "from service.cli import main; main()")
COMMANDS = (
    "demo", "serve", "doctor", "sweep", "import", "export", "calibrate", "apply", "simulate",
    "spectral-response",
)  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_takes_json_and_explains_itself(run: Run, command: str) -> None:
    ran = run(command, "--help")
    assert ran.status == 0
    assert "--json" in ran.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ("nonsense",),
        ("calibrate",),
        ("calibrate", "rec.h5"),
        ("simulate", "demo", "p.toml", "--out", "r", "--seed", "x"),
        ("sweep", "plan.toml"),
        ("store", "certify", "0123456789"),
    ],
)
def test_wrong_usage_is_status_2(run: Run, arguments: tuple[str, ...]) -> None:
    assert run(*arguments).status == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ("calibrate", "nowhere.h5", "--out", "set.h5"),
        ("import", "nowhere", "--out", "rec.h5"),
        ("export", "nowhere.h5", "--out", "folder"),
        ("sweep", "nowhere.toml", "--out", "rec.h5"),
        ("sweep", "nowhere.toml", "--dry-run"),
        ("simulate", "nowhere.toml", "nowhere.toml", "--out", "rec.h5"),
        ("simulate", "nopreset", "nowhere.toml", "--out", "rec.h5"),
        ("apply", "nowhere.h5", "nowhere.h5", "--out", "out.h5"),
        ("spectral-response", "nowhere", "--out", "response.csv"),
        ("store", "add", "nowhere.h5"),
        ("store", "add-recording", "nowhere.h5"),
        ("store", "show", "0123456789"),
        ("serve", "--host", "0.0.0.0"),  # noqa: S104
    ],
)
def test_what_cannot_be_done_is_one_line_status_1_and_an_error_in_json(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = run(*arguments, "--json", "-")
    assert ran.status == 1
    assert set(ran.json["error"]) == {"code", "message"}
    assert ran.error_code not in {"internal-error", "system-error"}
    lines = ran.stderr.strip().splitlines()
    assert len(lines) == 1
    assert lines[0] == f"darkflat: {ran.json['error']['message']}"
    assert [path.name for path in tmp_path.iterdir() if path.name != "home"] == []


def test_without_json_nothing_but_the_line_is_printed(run: Run, tmp_path: Path) -> None:
    ran = run("calibrate", tmp_path / "nowhere.h5", "--out", tmp_path / "set.h5")
    assert (ran.status, ran.stdout) == (1, "")


def test_an_answer_that_cannot_be_written_is_status_1(
    run: Run, tmp_path: Path, plan_file: Path
) -> None:
    ran = run("sweep", plan_file, "--dry-run", "--json", tmp_path / "no" / "answer.json")
    assert ran.status == 1
    assert "answer.json" in ran.stderr


def test_a_full_disk_or_a_missing_right_is_one_line(tmp_path: Path) -> None:
    import typer

    answer = tmp_path / "answer.json"
    with pytest.raises(typer.Exit) as left, answering(str(answer)):
        raise PermissionError(13, "Permission denied", "/somewhere")
    assert left.value.exit_code == 1
    assert json.loads(answer.read_text())["error"]["code"] == "system-error"


def test_a_defect_is_named_as_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import typer

    with pytest.raises(typer.Exit), answering(None):
        raise KeyError("surprise")
    assert "defect" in capsys.readouterr().err


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys, service.cli;"
        "print([m for m in ('numpy', 'h5py', 'scipy', 'numba', 'sqlalchemy', 'fastapi', 'pydantic',"
        " 'matplotlib', 'gi', 'astropy') if m in sys.modules])"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


def test_progress_never_touches_standard_output(recording_file: Path, tmp_path: Path) -> None:
    ran = subprocess.run(
        [*DARKFLAT, "export", recording_file, "--out", tmp_path / "folder", "--json", "-"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "FORCE_COLOR": "1"},
    )
    assert json.loads(ran.stdout)["blocks"] == 9


def test_dry_run_names_every_step(run: Run, plan_file: Path) -> None:
    ran = run("sweep", plan_file, "--dry-run", "--json", "-")
    assert ran.status == 0
    assert [step["block"] for step in ran.json["steps"]] == [f"{i:03d}" for i in range(9)]
    assert len(run("sweep", plan_file, "--dry-run").stdout.strip().splitlines()) == 10
