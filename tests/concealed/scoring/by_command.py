"""The diagnosis as everybody has it: the command line."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any


def diagnose(recording: Path) -> dict[str, Any]:
    """Return what `darkflat diagnose --json -` says of `recording`."""
    start = [sys.executable, "-c", "from service.cli import main; main()"]
    command = [*start, "diagnose", str(recording), "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr else "it failed")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer
