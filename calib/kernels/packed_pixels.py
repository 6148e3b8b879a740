"""Two 12-bit pixels in three bytes: the two ways in which cameras pack them.

`Mono12Packed` (GigE Vision 1.x) puts the high eight bits of each pixel into a byte of its own and
both low nibbles into the middle one; `Mono12p` (PFNC) is a stream of bits, least significant
first. Bytes of one decoded as the other are plausible pictures, and wrong.

    Mono12Packed   A11..A4 | B3..B0 A3..A0 | B11..B4
    Mono12p        A7..A0  | B3..B0 A11..A8 | B11..B4
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def unpack_mono12packed(packed: NDArray[np.uint8], pixels: NDArray[np.uint16]) -> None:
    """Fill `pixels`, (n,) uint16, from `packed`, at least ceil(3 n / 2) bytes."""
    for pair in range(pixels.size // 2):
        middle = packed[3 * pair + 1]
        pixels[2 * pair] = (np.uint16(packed[3 * pair]) << 4) | (middle & 0x0F)
        pixels[2 * pair + 1] = (np.uint16(packed[3 * pair + 2]) << 4) | (middle >> 4)
    if pixels.size % 2:
        start = 3 * (pixels.size // 2)
        pixels[-1] = (np.uint16(packed[start]) << 4) | (packed[start + 1] & 0x0F)


@njit(cache=True, nogil=True)
def unpack_mono12p(packed: NDArray[np.uint8], pixels: NDArray[np.uint16]) -> None:
    """Fill `pixels`, (n,) uint16, from `packed`, at least ceil(3 n / 2) bytes."""
    for pair in range(pixels.size // 2):
        middle = packed[3 * pair + 1]
        pixels[2 * pair] = packed[3 * pair] | (np.uint16(middle & 0x0F) << 8)
        pixels[2 * pair + 1] = (np.uint16(packed[3 * pair + 2]) << 4) | (middle >> 4)
    if pixels.size % 2:
        start = 3 * (pixels.size // 2)
        pixels[-1] = packed[start] | (np.uint16(packed[start + 1] & 0x0F) << 8)


@njit(cache=True, nogil=True)
def pack_mono12packed(pixels: NDArray[np.uint16], packed: NDArray[np.uint8]) -> None:
    """Fill `packed`, at least ceil(3 n / 2) bytes, from `pixels`, (n,) of 12 bits."""
    for pair in range(pixels.size // 2):
        first, second = pixels[2 * pair], pixels[2 * pair + 1]
        packed[3 * pair] = first >> 4
        packed[3 * pair + 1] = (first & 0x0F) | ((second & 0x0F) << 4)
        packed[3 * pair + 2] = second >> 4
    if pixels.size % 2:
        start = 3 * (pixels.size // 2)
        packed[start] = pixels[-1] >> 4
        packed[start + 1] = pixels[-1] & 0x0F


@njit(cache=True, nogil=True)
def pack_mono12p(pixels: NDArray[np.uint16], packed: NDArray[np.uint8]) -> None:
    """Fill `packed`, at least ceil(3 n / 2) bytes, from `pixels`, (n,) of 12 bits."""
    for pair in range(pixels.size // 2):
        first, second = pixels[2 * pair], pixels[2 * pair + 1]
        packed[3 * pair] = first & 0xFF
        packed[3 * pair + 1] = (first >> 8) | ((second & 0x0F) << 4)
        packed[3 * pair + 2] = second >> 4
    if pixels.size % 2:
        start = 3 * (pixels.size // 2)
        packed[start] = pixels[-1] & 0xFF
        packed[start + 1] = pixels[-1] >> 8
