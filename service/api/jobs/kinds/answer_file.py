"""The answer of a job as a file beside its others."""

from pathlib import Path
from typing import Any

from calib.recording.durable import write_whole
from service.store.plain_json import dumps


def write_answer(files: Path, answer: dict[str, Any]) -> dict[str, Any]:
    """Write `answer.json`, the same as the command's `--json`; return the answer."""
    write_whole(files / "answer.json", dumps(answer).encode("utf-8"))
    return answer
