"""TIFF: one page of lines, or one page per frame of an area sensor; greyscale, integer codes."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import tifffile
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.formats.frame_file import FrameFile, mapped, truncated, unreadable
from calib.recording.header import CameraHeader


def read(path: Path, camera: CameraHeader) -> FrameFile:
    """Open `path`, memory-mapped where it is not compressed."""
    try:
        with tifffile.TiffFile(path) as tiff:
            return _opened(path, tiff, camera)
    except tifffile.TiffFileError as error:
        raise unreadable(path, error) from error
    except (ValueError, IndexError, KeyError, OSError) as error:
        raise truncated(path) from error


def _opened(path: Path, tiff: tifffile.TiffFile, camera: CameraHeader) -> FrameFile:
    series = tiff.series[0]
    if series.keyframe.samplesperpixel != 1 or series.keyframe.photometric not in (0, 1):
        raise InputError(
            f"{path} is a colour image: save the sensor's raw codes as greyscale",
            code="frames-not-monochrome",
        )
    if len(tiff.series) > 1:
        raise unreadable(path, f"its pages differ, they form {len(tiff.series)} images")
    shape = tuple(int(n) for n in series.shape)
    if camera.rows is not None and len(shape) == 2:
        shape = (1, *shape)
    if series.dataoffset is not None:
        return mapped(
            path, np.dtype(tiff.byteorder + series.dtype.str[1:]), series.dataoffset, shape
        )
    n_pages = len(series.pages)

    def stretch(first: int, last: int) -> NDArray[Any]:
        # Compressed pages: those of the stretch, or the one page that there is.
        if n_pages == shape[0]:
            pages = tifffile.imread(path, key=range(first, last))
            return np.asarray(pages).reshape(last - first, *shape[1:])
        return np.asarray(tifffile.imread(path)).reshape(shape)[first:last]

    return FrameFile(shape, series.dtype, stretch)


def write(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[Any], stretches: Iterable[RawLines]
) -> None:
    """Write an uncompressed file; BigTIFF where it is longer than 4 GB."""
    where = tifffile.imwrite(
        path, shape=shape, dtype=dtype, photometric="minisblack", returnoffset=True, byteorder="<"
    )
    if where is None:
        raise unreadable(path, "its frames would not stand in one piece")
    with path.open("r+b") as file:
        file.seek(where[0])
        for dn in stretches:
            file.write(dn.data)
