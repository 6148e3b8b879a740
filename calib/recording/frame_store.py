"""The `frames` of an open .h5 file in SWMR mode: one chunk per frame, flushed per frame."""

import os
from pathlib import Path

import h5py

from calib.arrays import RawLines
from calib.errors import DarkflatError
from calib.recording.durable import DiskFullError, is_disk_full, sync

# HDF5's metadata needs room too; a file that runs out of it in the middle of a flush cannot even
# be closed, so writing stops while a frame and this still fit.
_RESERVE_BYTES = 1 << 20


class FrameStore:
    """Writes frames; after a failed write it takes no more, and leaves the file salvageable."""

    def __init__(self, file: h5py.File, path: Path) -> None:
        self._file = file
        self._frames = file["frames"]
        self._path = path
        self._failed = False

    @property
    def frame_lines(self) -> int:
        """Lines per frame."""
        return int(self._frames.chunks[1])

    def write(self, index: int, dn: RawLines) -> None:
        """Put `dn` at `index` and flush; a short frame is padded with 0, its line says so."""
        if self._failed:
            raise DarkflatError(
                f"{self._path} takes no more frames since a write failed: close and resume it",
                code="recording-failed",
            )
        self._check_room()
        try:
            if index >= len(self._frames):
                self._frames.resize(index + 1, axis=0)
            self._frames[index, : len(dn)] = dn
            self._frames.flush()
        except (OSError, RuntimeError) as error:
            self._failed = True
            raise self._failure(error) from error

    def _check_room(self) -> None:
        room = os.statvfs(self._path)
        chunk_bytes = self._frames.id.get_create_plist().get_chunk()
        needed = self._frames.dtype.itemsize
        for size in chunk_bytes:
            needed *= size
        if room.f_bavail * room.f_frsize < needed + _RESERVE_BYTES:
            raise DiskFullError(self._path)

    def _failure(self, error: Exception) -> DarkflatError:
        if isinstance(error, OSError) and is_disk_full(error):
            return DiskFullError(self._path)
        return DarkflatError(
            f"cannot write {self._path}: {str(error).splitlines()[0]}; close and resume it",
            code="cannot-write",
        )

    def sync(self) -> None:
        """Return once all frames are on the disk itself."""
        sync(self._path)

    def close(self) -> None:
        """Close the file; where a write failed before, HDF5 may not manage, and need not."""
        try:
            self._file.close()
        except (OSError, RuntimeError) as error:
            if not self._failed:
                raise self._failure(error) from error
