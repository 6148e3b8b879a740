"""A file for HDF5 whose writes never fail: HDF5 crashes the process that met a full disk.

What happens: a write that fails leaves HDF5 with pages that it tries to write again when the file
is closed, and once more at the end of the process, which then dies of SIGSEGV. Here the first
failure is kept for the caller and everything behind it is dropped, so that HDF5 closes in peace.
"""

import io
import os
from pathlib import Path


class UnfailingFile(io.RawIOBase):
    """A new file; give it to `h5py.File(..., "w")` and `check` it after each step.

    Attributes:
        error: The first write that failed; None while none did.
    """

    def __init__(self, path: Path) -> None:
        """Make the file; OSError where that cannot be done."""
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o666)
        self._at = 0
        self._end = 0
        self.error: OSError | None = None

    def check(self) -> None:
        """Raise the OSError of the first write that failed; the file is then of no use."""
        if self.error is not None:
            raise self.error

    def readable(self) -> bool:
        """Return True."""
        return True

    def writable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True

    def tell(self) -> int:
        """Return the position."""
        return self._at

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a position and return it."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._end}[whence]
        self._at = start + offset
        return self._at

    def readinto(self, buffer: bytearray | memoryview, /) -> int:  # type: ignore[override]
        """Fill `buffer`; with zeros where a write was dropped."""
        view = memoryview(buffer).cast("B")
        content = os.pread(self._descriptor, len(view), self._at)
        view[: len(content)] = content
        view[len(content) :] = bytes(len(view) - len(content))
        self._at += len(view)
        return len(view)

    def write(self, content: bytes | memoryview, /) -> int:  # type: ignore[override]
        """Write all of `content`, or drop it."""
        view = memoryview(content).cast("B")
        done = 0
        while self.error is None and done < len(view):
            try:
                done += os.pwrite(self._descriptor, view[done:], self._at + done)
            except OSError as error:
                self.error = error
        self._at += len(view)
        self._end = max(self._end, self._at)
        return len(view)

    def truncate(self, size: int | None = None, /) -> int:
        """Cut or extend the file, or keep why that cannot be done."""
        self._end = self._at if size is None else size
        if self.error is None:
            try:
                os.ftruncate(self._descriptor, self._end)
            except OSError as error:
                self.error = error
        return self._end

    def close(self) -> None:
        """Close the file; safe to call twice."""
        if not self.closed:
            os.close(self._descriptor)
        super().close()
