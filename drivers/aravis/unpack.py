"""From the bytes of a frame to its codes."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.packed_pixels import unpack_mono12p, unpack_mono12packed
from drivers.pixel_formats import FormatCode

ByteOrder = Literal["little", "big"]


def unpacked(
    raw: NDArray[np.uint8],
    code: FormatCode,
    n_lines: int,
    n_columns: int,
    byte_order: ByteOrder = "little",
) -> RawLines:
    """Return the codes of one frame, the caller's own.

    Args:
        raw: The frame's bytes, (n_bytes,), at least as many as the format needs; padding after
            the image is ignored.
        code: The pixel format that the frame's leader tells.
        n_lines: Lines of the frame.
        n_columns: Columns of a line.
        byte_order: Of formats with two bytes a pixel. Both transports say little; a camera that
            says otherwise does so in `DeviceStreamChannelEndianness`.

    Returns:
        (n_lines, n_columns), uint8 for Mono8, else uint16 in this machine's byte order.

    Raises:
        ValueError: `raw` is too short: Aravis calls a truncated frame a success.
    """
    n_pixels = n_lines * n_columns
    n_bytes = code.n_bytes(n_pixels)
    if raw.size < n_bytes:
        raise ValueError(
            f"{raw.size} bytes where {n_columns} x {n_lines} pixels of {code.name} take {n_bytes}"
        )
    image = raw[:n_bytes]
    if code.name == "Mono8":
        return image.reshape(n_lines, n_columns).copy()
    if code.bits_on_the_wire == 16:
        on_wire = image.view("<u2" if byte_order == "little" else ">u2")
        return on_wire.astype(np.uint16).reshape(n_lines, n_columns)
    pixels = np.empty(n_pixels, np.uint16)
    unpack = unpack_mono12packed if code.name == "Mono12Packed" else unpack_mono12p
    unpack(image, pixels)
    return pixels.reshape(n_lines, n_columns)


def warm_up(code: FormatCode) -> None:
    """Compile what `code` is unpacked with: with frames coming in there is no time for it."""
    unpacked(np.zeros(code.n_bytes(2), np.uint8), code, 1, 2)
