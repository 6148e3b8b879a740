"""What codes a camera may have sent: type, shape and range; their canonical bytes."""

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.header import CameraHeader


def code_type(camera: CameraHeader) -> np.dtype[Any]:
    """Return uint8 for 8-bit codes, little-endian uint16 for longer ones."""
    return np.dtype("u1" if camera.bit_depth == 8 else "<u2")


def sample_shape(camera: CameraHeader) -> tuple[int, ...]:
    """Return (n_columns,) of a line, or (n_rows, n_columns) of an area sensor's frame."""
    if camera.rows is None:
        return (camera.columns,)
    return (camera.rows, camera.columns)


def check_kind(dtype: np.dtype[Any], shape: tuple[int, ...], camera: CameraHeader, at: str) -> None:
    """Raise InputError unless (n, *sample_shape) of uint8 or uint16; `at` says where it is."""
    wanted = sample_shape(camera)
    if dtype.kind != "u" or dtype.itemsize > 2 or (dtype.itemsize == 1 and camera.bit_depth > 8):
        raise InputError(
            f"{at} holds {dtype.name}, but {camera.bit_depth}-bit codes are "
            f"{'uint8 or uint16' if camera.bit_depth == 8 else 'uint16'}: save the raw codes",
            code="frames-wrong-dtype",
        )
    if len(shape) != len(wanted) + 1 or shape[1:] != wanted or shape[0] == 0:
        raise InputError(
            f"{at} has shape {_text(shape)}, but the camera's header says "
            f"(n, {', '.join(map(str, wanted))}): correct columns or rows, or the frames",
            code="frames-wrong-shape",
        )


def checked_codes(dn: NDArray[Any], camera: CameraHeader, at: str) -> RawLines:
    """Return `dn` in the canonical type; InputError where a code is above full scale."""
    check_kind(dn.dtype, dn.shape, camera, at)
    highest = int(dn.max())
    if highest > camera.full_scale_dn:
        raise InputError(
            f"{at} holds the code {highest}, above {camera.full_scale_dn} of {camera.bit_depth} "
            "bits: correct bit_depth, or shift the codes down",
            code="code-above-full-scale",
        )
    codes: RawLines = np.ascontiguousarray(dn, dtype=code_type(camera))
    return codes


def crc32_of(dn: RawLines) -> int:
    """Return the CRC-32 of contiguous codes (little-endian, C order)."""
    return zlib.crc32(dn.data)


def _text(shape: tuple[int, ...]) -> str:
    return f"({', '.join(map(str, shape))}{',' if len(shape) == 1 else ''})"
