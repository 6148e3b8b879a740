"""What a command left behind."""

import json
from dataclasses import dataclass
from math import inf
from typing import Any

import pytest


def without_progress(patch: pytest.MonkeyPatch) -> None:
    """Print no line now and then of how far a command is: how many come depends on the machine."""
    patch.setattr("service.cli.progress._LINE_EVERY_S", inf)


@dataclass(frozen=True)
class Ran:
    """Exit status and what was printed."""

    status: int
    stdout: str
    stderr: str

    @property
    def json(self) -> dict[str, Any]:
        """Standard output, which must be JSON and nothing else."""
        content: dict[str, Any] = json.loads(self.stdout)
        return content

    @property
    def error_code(self) -> str:
        """The code of the error in the JSON answer."""
        return str(self.json["error"]["code"])
