"""The `frames` of an open .h5 file in SWMR mode: one chunk per frame, flushed per frame."""

import os
from pathlib import Path

import h5py
import numpy as np

from calib.arrays import RawLines
from calib.errors import DarkflatError
from calib.recording.durable import DiskFullError, disk_errors, is_disk_full
from calib.recording.superblock import give_back_unused

# HDF5's metadata needs room too: this much at once, and this much more for each frame.
_METADATA_BYTES = 1 << 20
_METADATA_BYTES_PER_FRAME = 256

# HDF5 crashes the process when it is made to close a file that it could not write; such files
# are kept open until the process ends, and are then as if it had been killed.
_abandoned: list[object] = []


class FrameStore:
    """Writes frames; after a failed write it takes no more, and leaves the file salvageable."""

    def __init__(self, file: h5py.File, path: Path) -> None:
        self._file = file
        self._frames = file["frames"]
        self._path = path
        self._failed = False
        self._n_written = 0
        self._frame_bytes = int(np.prod(self._frames.chunks)) * self._frames.dtype.itemsize
        self._descriptor = os.open(path, os.O_RDWR | os.O_CLOEXEC)
        self._base_bytes = os.fstat(self._descriptor).st_size

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
        self._reserve()
        try:
            if index >= len(self._frames):
                self._frames.resize(index + 1, axis=0)
            self._frames[index, : len(dn)] = dn
            self._frames.flush()
            self._n_written += 1
        except (OSError, RuntimeError) as error:
            self._failed = True
            raise self._failure(error) from error

    def _reserve(self) -> None:
        # The disk gives the room for the next frame before HDF5 is told of it, so that a full
        # disk is met outside of HDF5 and the file can still be closed; `close` gives the rest back.
        per_frame = self._frame_bytes + _METADATA_BYTES_PER_FRAME
        size = self._base_bytes + (self._n_written + 1) * per_frame + _METADATA_BYTES
        with disk_errors(self._path):
            os.posix_fallocate(self._descriptor, 0, size)

    def _failure(self, error: Exception) -> DarkflatError:
        if isinstance(error, OSError) and is_disk_full(error):
            return DiskFullError(self._path)
        return DarkflatError(
            f"cannot write {self._path}: {str(error).splitlines()[0]}; close and resume it",
            code="cannot-write",
        )

    def sync(self) -> None:
        """Return once all frames are on the disk itself."""
        with disk_errors(self._path):
            os.fsync(self._descriptor)

    def close(self) -> None:
        """Close the file; safe to call twice. One that could not be written is abandoned."""
        if self._descriptor < 0:
            return
        os.close(self._descriptor)
        self._descriptor = -1
        if self._failed:
            _abandoned.append((self._file, self._frames))
            return
        try:
            self._file.close()
            give_back_unused(self._path)
        except (OSError, RuntimeError) as error:
            self._failed = True
            _abandoned.append((self._file, self._frames))
            raise self._failure(error) from error
