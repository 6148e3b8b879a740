"""Starts sweeps, kills them at chosen moments, and compares what was acknowledged."""

import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.recording.commit_log import commit_path
from tests.service.sequencer.sweeping import NEVER_ENDING

ROOT = Path(__file__).parents[3]


@dataclass(frozen=True)
class Sweep:
    """What is swept, and where the recording goes."""

    bench: Path
    plan: Path
    out: Path
    deadline_s: float = 240.0

    def start(self, *, ends: bool = True, **options: Any) -> subprocess.Popen[bytes]:
        """Begin or resume it in a process of its own; unless it `ends` it waits to be killed."""
        command = [sys.executable, "-m", "tests.service.sequencer.sweeping"]
        files = [str(path) for path in (self.bench, self.plan, self.out)]
        never = [] if ends else [NEVER_ENDING]
        return subprocess.Popen([*command, *files, *never], cwd=ROOT, **options)

    def acknowledged(self) -> list[bytes]:
        """Return the whole lines of the commit record so far."""
        path = commit_path(self.out)
        lines = path.read_bytes() if path.exists() else b""
        return lines.split(b"\n")[:-1]

    def frames(self) -> int:
        """Return how many frames are acknowledged."""
        return sum(b'"kind":"frame"' in line for line in self.acknowledged())

    def kill_after(self, n_frames: int, delay_s: float) -> list[bytes]:
        """Kill the process `delay_s` after `n_frames` more were acknowledged; return the record.

        However late that is, it finds the process: the sweep waits within its last block.
        """
        until = self.frames() + n_frames
        process = self.start(ends=False)
        try:
            self.wait_for(until, process)
            time.sleep(delay_s)
            assert process.poll() is None, "the sweep ended before it was killed"
        finally:
            process.kill()
            process.wait()
        return self.acknowledged()

    def wait_for(self, n_frames: int, process: subprocess.Popen[bytes]) -> None:
        """Return once `n_frames` are acknowledged; fails where `process` ended before."""
        give_up_s = time.monotonic() + self.deadline_s
        while self.frames() < n_frames:
            assert process.poll() is None, "the sweep ended early"
            assert time.monotonic() < give_up_s, "the sweep does not get on"
            time.sleep(0.01)

    def finish(self) -> None:
        """Let it come to its end."""
        process = self.start()
        try:
            assert process.wait(self.deadline_s) == 0
        finally:
            process.kill()
            process.wait()
