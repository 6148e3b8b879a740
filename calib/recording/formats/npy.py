"""NumPy's .npy."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from calib.arrays import RawLines
from calib.recording.formats.frame_file import FrameFile, mapped, truncated, unreadable
from calib.recording.header import CameraHeader


def read(path: Path, _camera: CameraHeader) -> FrameFile:
    """Open `path` memory-mapped."""
    with path.open("rb") as file:
        try:
            version = np.lib.format.read_magic(file)
            read_header = (
                np.lib.format.read_array_header_1_0
                if version == (1, 0)
                else np.lib.format.read_array_header_2_0
            )
            shape, fortran_order, dtype = read_header(file)
        except (ValueError, EOFError) as error:
            raise (
                truncated(path) if path.stat().st_size < 128 else unreadable(path, error)
            ) from error
        offset = file.tell()
    if fortran_order:
        raise unreadable(path, "its axes are in Fortran order")
    if dtype.hasobject:
        raise unreadable(path, "it holds Python objects")
    return mapped(path, dtype, offset, shape)


def write(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[Any], stretches: Iterable[RawLines]
) -> None:
    """Write a version 1.0 file."""
    header = {
        "descr": np.lib.format.dtype_to_descr(dtype),
        "fortran_order": False,
        "shape": shape,
    }
    with path.open("xb") as file:
        np.lib.format.write_array_header_1_0(file, header)
        for dn in stretches:
            file.write(dn.data)
