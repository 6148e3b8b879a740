"""The diagnosis as everybody has it: the command, in a process that need not start anew."""

import json
import tempfile
from pathlib import Path
from typing import Any

import typer.testing

from service.cli.app import app


def diagnose(recording: Path) -> dict[str, Any]:
    """Return what `darkflat diagnose --json` says of `recording`."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "answer.json"
        done = typer.testing.CliRunner().invoke(
            app, ["diagnose", str(recording), "--json", str(path)]
        )
        if done.exit_code != 0:
            raise RuntimeError(f"{done.exception} {done.output}".strip())
        answer: dict[str, Any] = json.loads(path.read_text("utf-8"))
    return answer
