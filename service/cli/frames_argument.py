"""What `apply` takes for FRAMES: a recording, or a bare file of lines."""

import hashlib
from collections.abc import Iterator
from math import isfinite
from pathlib import Path

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.formats.catalogue import FORMATS
from calib.recording.formats.frame_file import FrameFile
from calib.recording.frame_codes import checked_codes
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.open import open_recording
from calib.recording.protocol import Recording

_STRETCH_LINES = 256


class BareLines:
    """A file of lines that says nothing of its camera, read as a recording of one block."""

    def __init__(self, path: Path, camera: CameraHeader, exposure_us: float) -> None:
        self._path = path
        self._file: FrameFile = FORMATS[path.suffix.lower()].read(path, camera)
        shape, dtype = self._file.shape, self._file.dtype
        if len(shape) != 2 or 0 in shape or dtype.name not in {"uint8", "uint16"}:
            msg = (
                f"{path} holds {dtype} of shape {shape}; give lines of uint8 or uint16,"
                " (n_lines, n_columns)"
            )
            raise InputError(msg, code="wrong-shape")
        block = Block(block=path.stem, kind="scene", exposure_us=exposure_us, lines=shape[0])
        as_set = camera.model_copy(update={"columns": shape[1]})
        self._header = RecordingHeader(camera=as_set, blocks=(block,))

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    @property
    def header(self) -> RecordingHeader:
        """The set's camera, and one block."""
        return self._header

    @property
    def warnings(self) -> tuple[str, ...]:
        """That nobody knows whether the set matches."""
        return (f"{self._path.name} does not say its camera: taken to be the set's",)

    def frames(self, block: str) -> Iterator[RawLines]:
        """Yield stretches of lines."""
        if block != self._path.stem:
            msg = f"{self._path} has no block {block}."
            raise InputError(msg, code="no-such-block")
        n_lines = self._file.shape[0]
        for first in range(0, n_lines, _STRETCH_LINES):
            dn = self._file.stretch(first, min(first + _STRETCH_LINES, n_lines))
            yield checked_codes(dn, self._header.camera, str(self._path))

    def digest(self) -> str:
        """Return the SHA-256 of the codes."""
        sha = hashlib.sha256()
        for dn in self.frames(self._path.stem):
            sha.update(np.ascontiguousarray(dn).data)
        return sha.hexdigest()


def open_frames(path: Path, camera: CameraHeader, exposure_us: float | None) -> Recording:
    """Return the recording at `path`, or the bare lines in it as one.

    Args:
        path: An .h5 file, a recording folder, or an .npy, .tif or .fits file.
        camera: What a bare file is taken to be from.
        exposure_us: Of a bare file; a recording knows its own.

    Raises:
        InputError: `exposure-missing`, `exposure-known`, or what is wrong with the file.
    """
    if exposure_us is not None and not (isfinite(exposure_us) and exposure_us > 0):
        msg = f"an exposure of {exposure_us:g} µs cannot be corrected: give --exposure-us above 0"
        raise InputError(msg, code="bad-exposure")
    if path.is_dir() or path.suffix.lower() not in FORMATS:
        if exposure_us is not None:
            msg = (
                f"{path} is no file of lines ({', '.join(FORMATS)}), and a recording states its"
                " exposures itself: leave --exposure-us out"
            )
            raise InputError(msg, code="exposure-known")
        return open_recording(path)
    if not path.is_file():
        raise InputError(f"{path} does not exist: name a file of lines", code="not-found")
    if exposure_us is None:
        msg = f"{path} does not say how long its lines were exposed: give --exposure-us"
        raise InputError(msg, code="exposure-missing")
    return BareLines(path, camera, exposure_us)
