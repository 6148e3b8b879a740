"""What every format of frames gives: shape, type, and stretches on demand."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class FrameFile:
    """An open file of frames.

    Attributes:
        shape: (n_lines, n_columns), or (n_frames, n_rows, n_columns) of an area sensor.
        dtype: What the file holds, in native byte order.
        stretch: Returns the samples first .. last - 1 along the first axis.
    """

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    stretch: Callable[[int, int], NDArray[Any]]


class FrameFormat(Protocol):
    """A module under `formats` is one of these."""

    def read(self, path: Path, camera: CameraHeader) -> FrameFile:
        """Open `path`; InputError says in one sentence what is wrong with it."""
        ...

    def write(
        self,
        path: Path,
        shape: tuple[int, ...],
        dtype: np.dtype[Any],
        stretches: Iterable[RawLines],
    ) -> None:
        """Write `stretches`, together of `shape`."""
        ...


def truncated(path: Path) -> InputError:
    """Return the error for a file that ends too early."""
    return InputError(
        f"{path} is truncated: copy it again from where it was recorded", code="frames-truncated"
    )


def unreadable(path: Path, reason: object) -> InputError:
    """Return the error for a file that is not what its name says."""
    return InputError(
        f"{path} cannot be read ({reason}): save it again or convert it", code="frames-unreadable"
    )


def mapped(path: Path, dtype: np.dtype[Any], offset: int, shape: tuple[int, ...]) -> FrameFile:
    """Return codes that stand uncompressed from byte `offset` on; InputError when cut short."""
    if path.stat().st_size < offset + int(np.prod(shape)) * dtype.itemsize:
        raise truncated(path)
    codes = np.memmap(path, dtype, "r", offset, shape)
    native = dtype.newbyteorder("=")
    return FrameFile(shape, native, lambda first, last: np.asarray(codes[first:last], dtype=native))
