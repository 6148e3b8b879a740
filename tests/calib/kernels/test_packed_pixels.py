from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.packed_pixels import (
    pack_mono12p,
    pack_mono12packed,
    unpack_mono12p,
    unpack_mono12packed,
)


def bits_of(pixels: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Mono12p by its definition: every pixel's bits, least significant first, in a row."""
    bits = (pixels[:, None] >> np.arange(12, dtype=np.uint16)) & 1
    return np.packbits(bits.astype(np.uint8).ravel(), bitorder="little")


def nibbles_of(pixels: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Mono12Packed by its definition: high byte, both low nibbles (the first below), high byte."""
    pairs = np.append(pixels, 0)[: 2 * ((pixels.size + 1) // 2)].reshape(-1, 2)
    first, second = pairs.T
    rows = np.stack([first >> 4, (first & 15) | ((second & 15) << 4), second >> 4], axis=1)
    return rows.astype(np.uint8).ravel()[: (12 * pixels.size + 7) // 8]


@pytest.mark.parametrize("n", [1, 2, 3, 10, 1001, 4096])
@pytest.mark.parametrize(
    ("pack", "unpack", "twin"),
    [
        (pack_mono12p, unpack_mono12p, bits_of),
        (pack_mono12packed, unpack_mono12packed, nibbles_of),
    ],
    ids=["Mono12p", "Mono12Packed"],
)
def test_packing_agrees_with_the_definition_and_back(
    pack: Callable[[NDArray[np.uint16], NDArray[np.uint8]], None],
    unpack: Callable[[NDArray[np.uint8], NDArray[np.uint16]], None],
    twin: Callable[[NDArray[np.uint16]], NDArray[np.uint8]],
    n: int,
) -> None:
    pixels = np.random.default_rng().integers(0, 4096, n).astype(np.uint16)
    packed = np.zeros((12 * n + 7) // 8, np.uint8)
    pack(pixels, packed)
    assert np.array_equal(packed, twin(pixels))
    back = np.empty(n, np.uint16)
    unpack(packed, back)
    assert np.array_equal(back, pixels)
