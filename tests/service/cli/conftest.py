from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from service.cli.app import app
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.cli.answers import Ran, without_progress

__all__ = ["plan_file", "recording_file"]


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home of its own for the store."""
    monkeypatch.setenv("DARKFLAT_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("DARKFLAT_BENCH", raising=False)
    return tmp_path / "home"


@pytest.fixture
def run(home: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Ran]:
    """Run `darkflat` with these arguments, in this process."""
    without_progress(monkeypatch)

    def in_process(*arguments: object) -> Ran:
        ran = CliRunner().invoke(app, [str(each) for each in arguments])
        return Ran(ran.exit_code, ran.stdout, ran.stderr)

    return in_process
