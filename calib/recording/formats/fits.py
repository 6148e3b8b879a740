"""FITS: unsigned 16-bit codes as signed ones with BZERO = 32768, 8-bit codes as they are.

Rows stand in the file in the order in which they were taken: line 0 first (FITS' row 1, which
viewers draw at the bottom); NAXIS1 counts columns, NAXIS2 lines (rows of an area sensor), NAXIS3
an area sensor's frames.

Source: FITS Standard, version 4.0, sections 4.4.1 and 5.2.5 (unsigned integers).
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.formats.frame_file import FrameFile, mapped, unreadable
from calib.recording.header import CameraHeader

_BLOCK = 2880
_SIGN = np.uint16(0x8000)
_TYPES = {8: ">u1", 16: ">i2", 32: ">i4", 64: ">i8", -32: ">f4", -64: ">f8"}


def read(path: Path, _camera: CameraHeader) -> FrameFile:
    """Open the primary image of `path` memory-mapped."""
    from astropy.io import fits  # noqa: PLC0415  (slow to import, and seldom needed)

    try:
        with path.open("rb") as file:
            header = fits.Header.fromfile(file)
            offset = file.tell()
    except (OSError, EOFError, ValueError) as error:
        raise unreadable(path, error) from error
    try:
        kind = _TYPES[header["BITPIX"]]
        shape = tuple(int(header[f"NAXIS{k}"]) for k in range(header["NAXIS"], 0, -1))
    except KeyError as error:
        raise unreadable(path, f"its header lacks {error}") from error
    if not shape or (header.get("BSCALE", 1) != 1) or header.get("BZERO", 0) not in (0, 1 << 15):
        raise unreadable(path, "its primary image holds no codes")
    stored = mapped(path, np.dtype(kind), offset, shape)
    if kind != ">i2":
        return stored
    signed = header.get("BZERO", 0) == 0

    def stretch(first: int, last: int) -> NDArray[Any]:
        codes = stored.stretch(first, last).view(np.uint16)
        if not signed:
            return codes ^ _SIGN
        if (codes & _SIGN).any():
            raise InputError(
                f"{path} holds negative numbers: save the raw codes, BZERO = 32768",
                code="frames-wrong-dtype",
            )
        return codes

    return FrameFile(shape, np.dtype(np.uint16), stretch)


def write(
    path: Path, shape: tuple[int, ...], dtype: np.dtype[Any], stretches: Iterable[RawLines]
) -> None:
    """Write a primary image."""
    from astropy.io import fits  # noqa: PLC0415  (slow to import, and seldom needed)

    header = fits.Header()
    header["SIMPLE"] = True
    header["BITPIX"] = 8 * dtype.itemsize
    header["NAXIS"] = len(shape)
    for k, n in enumerate(reversed(shape), start=1):
        header[f"NAXIS{k}"] = n
    if dtype.itemsize == 2:
        header["BSCALE"] = 1
        header["BZERO"] = 1 << 15
    header["BUNIT"] = "adu"
    with path.open("xb") as file:
        file.write(header.tostring(padding=True).encode("ascii"))
        for dn in stretches:
            file.write((dn if dtype.itemsize == 1 else (dn ^ _SIGN).astype(">u2")).tobytes())
        file.write(b"\0" * (-file.tell() % _BLOCK))
