"""One bench, one owner: two processes must not move the same lamps."""

import fcntl
import json
import os
import tempfile
from pathlib import Path
from typing import IO, Any

from drivers.errors import DeviceBusyError


class BenchLock:
    """A lock on a file that the system drops when its holder dies, however it dies.

    The file names the holder for those who find it locked; a file that nobody locks is stale,
    and taken over.
    """

    def __init__(self, bench_id: str, folder: Path | None = None) -> None:
        self.path = (folder or lock_folder()) / f"darkflat-{bench_id}.lock"
        self._file: IO[str] | None = None
        self._bench_id = bench_id

    def acquire(self) -> None:
        """Take the bench; raise DeviceBusyError, code `bench-busy`, naming who holds it."""
        file = os.fdopen(_opened(self.path), "r+", encoding="utf-8")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            holder = _holder(file)
            file.close()
            raise DeviceBusyError(
                f"the bench {self._bench_id!r} is in use by {holder}; wait until it ends, or end"
                " it (SIGTERM leaves the lamps off)",
                device=self._bench_id,
                code="bench-busy",
            ) from error
        file.truncate(0)
        file.write(json.dumps({"pid": os.getpid()}) + "\n")
        file.flush()
        self._file = file

    def release(self) -> None:
        """Give the bench back; safe to call twice."""
        if self._file is not None:
            self._file.truncate(0)
            self._file.close()
            self._file = None


def lock_folder() -> Path:
    """Return where all users of this machine find the locks."""
    shared = Path("/run/lock")
    return shared if os.access(shared, os.W_OK) else Path(tempfile.gettempdir())


def _opened(path: Path) -> int:
    """Open the file for every user, without emptying it: the holder's name must stay readable."""
    flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW
    try:
        # Without O_CREAT: in a shared folder the system refuses it for other users' files.
        return os.open(path, flags)
    except FileNotFoundError:
        descriptor = os.open(path, flags | os.O_CREAT, 0o666)
        os.fchmod(descriptor, 0o666)
        return descriptor


def _holder(file: IO[str]) -> str:
    try:
        content: Any = json.loads(file.read())
        return f"process {int(content['pid'])}"
    except (ValueError, KeyError, TypeError):
        return "a process that did not say who it is"
