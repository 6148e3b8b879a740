"""The commit record `<name>.frames.jsonl`: append-only, one JSON object per line.

A line is appended by one write() and so survives the death of the process as soon as `append`
returns; `sync` makes it survive a power cut as well. Whoever appends holds an exclusive lock,
which the system drops when the process dies, however it dies.
"""

import fcntl
import json
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calib.closing import Closing
from calib.errors import InputError
from calib.recording.durable import disk_errors

Entry = dict[str, Any]

_LOCK_TRIES = 5
_LOCK_PAUSE_S = 0.01


def commit_path(recording: Path) -> Path:
    """Return where the commit record of the .h5 file `recording` stands."""
    return recording.with_suffix(".frames.jsonl")


def check_ending(recording: Path) -> None:
    """Raise InputError unless `recording` ends in .h5: `commit_path` replaces the ending."""
    if recording.suffix != ".h5":
        raise InputError(
            f"{recording} does not end in .h5: name it {recording}.h5", code="output-not-h5"
        )


@dataclass(frozen=True)
class CommitLines:
    """What stands in a commit record.

    Attributes:
        entries: The whole lines.
        n_bytes: The length of these lines; what follows in the file is torn.
        torn: True where a torn line follows.
    """

    entries: tuple[Entry, ...]
    n_bytes: int
    torn: bool


def read_commit_lines(path: Path) -> CommitLines:
    """Read the whole lines; InputError where one before the last cannot be read."""
    try:
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(
            f"the commit record {path} is missing: without it no frame counts, put it back beside "
            "its .h5 file",
            code="commit-record-missing",
        ) from error
    end = content.rfind(b"\n") + 1
    entries = [_parse(line, number, path) for number, line in enumerate(content[:end].split(b"\n"))]
    return CommitLines(tuple(entry for entry in entries if entry), end, end < len(content))


def _parse(line: bytes, number: int, path: Path) -> Entry | None:
    if not line:
        return None
    try:
        entry = json.loads(line)
    except ValueError:
        entry = None
    if not isinstance(entry, dict) or "kind" not in entry:
        raise InputError(
            f"line {number + 1} of the commit record {path} is damaged: restore it from a copy",
            code="commit-record-damaged",
        )
    return entry


def is_being_written(path: Path) -> bool:
    """Tell whether a writer holds the lock on the commit record at `path`."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def _lock(descriptor: int) -> bool:
    """Take the writer's lock; a reader that just asks `is_being_written` is waited for."""
    for _ in range(_LOCK_TRIES):
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(_LOCK_PAUSE_S)
        else:
            return True
    return False


class CommitLog(Closing):
    """Appends lines; holds the lock until closed."""

    def __init__(self, path: Path, *, create: bool = False) -> None:
        """Open `path` for appending; InputError `recording-in-use` where somebody else does."""
        self._path = path
        flags = os.O_WRONLY | os.O_APPEND | os.O_CLOEXEC | (os.O_CREAT if create else 0)
        with disk_errors(path):
            self._descriptor = os.open(path, flags, 0o644)
        if not _lock(self._descriptor):
            os.close(self._descriptor)
            raise InputError(
                f"{path} is being written by another process: wait until it ends",
                code="recording-in-use",
            )

    def append(self, entry: Entry) -> None:
        """Add one line; on return the system has it. A line that fails leaves none behind."""
        line = json.dumps(entry, allow_nan=False, separators=(",", ":")).encode() + b"\n"
        before = os.fstat(self._descriptor).st_size
        with disk_errors(self._path):
            try:
                written = os.write(self._descriptor, line)
                while written < len(line):
                    written += os.write(self._descriptor, line[written:])
            except OSError:
                os.ftruncate(self._descriptor, before)
                raise

    def cut(self, n_bytes: int) -> None:
        """Drop what stands behind the first `n_bytes` (a torn line)."""
        with disk_errors(self._path):
            os.ftruncate(self._descriptor, n_bytes)

    def rename(self, path: Path) -> None:
        """Give the record its final name; the lock stays."""
        with disk_errors(path):
            self._path.rename(path)
        self._path = path

    def sync(self) -> None:
        """Return once every line is on the disk itself."""
        with disk_errors(self._path):
            os.fsync(self._descriptor)

    def close(self) -> None:
        """Give the lock back; safe to call twice."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1
