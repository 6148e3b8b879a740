"""Raw lines in .npy, as they are uploaded: checked before anything is computed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO, cast

import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError

_CODES = frozenset({"uint8", "uint16"})


@dataclass(frozen=True)
class UploadedLines:
    """Lines in a spooled file; read as often as needed, a stretch at a time.

    Attributes:
        file: An .npy file, open for reading.
        offset: Of the first code, bytes.
        n_lines: How many there are.
        n_columns: Of each.
        dtype: Of the codes, with the byte order of the file.
    """

    file: IO[bytes]
    offset: int
    n_lines: int
    n_columns: int
    dtype: np.dtype[np.uint8] | np.dtype[np.uint16]

    def stretches(self, n_lines: int) -> Iterator[RawLines]:
        """Yield up to `n_lines` lines at a time, in this machine's byte order."""
        self.file.seek(self.offset)
        line_bytes = self.n_columns * self.dtype.itemsize
        native = self.dtype.newbyteorder("=")
        for first in range(0, self.n_lines, n_lines):
            count = min(n_lines, self.n_lines - first)
            codes = np.frombuffer(self.file.read(count * line_bytes), dtype=self.dtype)
            lines = codes.reshape(count, self.n_columns).astype(native, copy=False)
            yield cast("RawLines", lines)


def uploaded_lines(file: IO[bytes], n_bytes: int, *, n_columns: int) -> UploadedLines:
    """Return the lines in `file`, which is `n_bytes` long.

    Raises:
        InputError: `not-npy`, `wrong-dtype`, `wrong-shape`, `wrong-columns`, `frames-truncated`.
    """
    file.seek(0)
    try:
        version = np.lib.format.read_magic(file)
        read = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, fortran_order, dtype = read(file)
    except (ValueError, KeyError, EOFError, TypeError, SyntaxError) as error:
        msg = "the body is not an .npy array; send what numpy.save writes"
        raise InputError(msg, code="not-npy") from error
    if dtype.name not in _CODES:
        msg = f"raw lines are uint8 or uint16, not {dtype}"
        raise InputError(msg, code="wrong-dtype")
    if len(shape) != 2 or fortran_order or 0 in shape:
        msg = f"an array of shape {shape} is not (n_lines, {n_columns}) in C order"
        raise InputError(msg, code="wrong-shape")
    if shape[1] != n_columns:
        msg = f"the lines have {shape[1]} columns, the coefficient set has {n_columns}"
        raise InputError(msg, code="wrong-columns")
    offset = file.tell()
    if n_bytes != offset + shape[0] * shape[1] * dtype.itemsize:
        msg = f"the body does not hold the {shape[0]} lines that it states; send it again"
        raise InputError(msg, code="frames-truncated")
    return UploadedLines(file, offset, *shape, dtype)
