"""Reading an HDF5 file whose SWMR writer died, without changing it.

HDF5 opens such a file for SWMR reading alone, and a SWMR reader takes damage for a write that it
has caught in the middle: it tries again up to 100 times, waiting twice as long each time, which is
for ever. Where nobody writes any more, the file is given to HDF5 as a closed one instead, so that
damage is an error at once.
"""

import io
import os
from pathlib import Path

from calib.recording.superblock import SUPERBLOCK_BYTES, as_closed


class AbandonedFile(io.RawIOBase):
    """The file's bytes, but a superblock that says it was closed, with this size."""

    def __init__(self, path: Path) -> None:
        """Open `path`, whose superblock must be sound."""
        self._file = path.open("rb", buffering=0)
        self._end = os.fstat(self._file.fileno()).st_size
        self._superblock = as_closed(self._file.read(SUPERBLOCK_BYTES), end=self._end)
        self._at = 0

    def readable(self) -> bool:
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
        """Fill `buffer`, whose bytes HDF5 owns (typeshed's Buffer cannot be indexed)."""
        view = memoryview(buffer).cast("B")
        self._file.seek(self._at)
        n_read = 0
        while n_read < len(view) and (n := self._file.readinto(view[n_read:])):
            n_read += n
        if self._at < SUPERBLOCK_BYTES:
            part = self._superblock[self._at : self._at + len(view)]
            view[: len(part)] = part
        self._at += n_read
        return n_read

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()
        super().close()
