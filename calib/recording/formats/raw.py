"""Headerless .raw: lines of codes one behind the other; `[camera] dtype` says of which type."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.formats.frame_file import FrameFile, mapped, truncated
from calib.recording.frame_codes import sample_shape
from calib.recording.header import CameraHeader


def read(path: Path, camera: CameraHeader) -> FrameFile:
    """Open `path` memory-mapped; its length must be a whole number of lines."""
    try:
        dtype = np.dtype(camera.dtype or "")
    except TypeError as error:
        raise InputError(
            f"{path} has no header and dtype = {camera.dtype!r} of [camera] does not say what it "
            'holds: write, for example, dtype = "<u2"',
            code="raw-dtype-unknown",
        ) from error
    one = sample_shape(camera)
    n_samples, rest = divmod(path.stat().st_size, int(np.prod(one)) * dtype.itemsize)
    if rest or not n_samples:
        raise truncated(path)
    return mapped(path, dtype, 0, (n_samples, *one))


def write(
    path: Path, _shape: tuple[int, ...], _dtype: np.dtype[Any], stretches: Iterable[RawLines]
) -> None:
    """Write the codes alone."""
    with path.open("xb") as file:
        for dn in stretches:
            file.write(dn.data)
