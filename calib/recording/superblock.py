"""Reopening an HDF5 file whose SWMR writer died.

HDF5 refuses such a file: "already open for write/SWMR write". Two fields of the superblock are in
the way. The file consistency flags still say that somebody writes; and the end-of-file address is
the one from before the SWMR writing, so that a writer that only cleared the flags (as `h5clear`
does unless told `--filesize`) would allocate over the frames. Both are set here, and the checksum.

Source: HDF5 File Format Specification version 3.0, II.A "Disk Format: Level 0A", superblock
version 3; checksum: Bob Jenkins' lookup3 `hashlittle`, initial value 0.
"""

import os
import struct
from dataclasses import dataclass
from pathlib import Path

from calib.errors import InputError
from calib.recording.durable import disk_errors

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MASK = 0xFFFFFFFF
# signature, version, size of offsets, size of lengths, consistency flags, then the addresses of
# base, superblock extension, end of file and root group
_SUPERBLOCK = struct.Struct("<8s4B4Q")
_CHECKSUM = struct.Struct("<I")
SUPERBLOCK_BYTES = _SUPERBLOCK.size + _CHECKSUM.size


def lookup3(data: bytes) -> int:
    """Return Jenkins' 32-bit hash of `data`.

    >>> hex(lookup3(b"Four score and seven years ago"))
    '0x17770551'
    """
    a = b = c = (0xDEADBEEF + len(data)) & _MASK
    if not data:
        return c
    n_words = 3 * ((len(data) + 11) // 12)
    words = struct.unpack(f"<{n_words}I", data.ljust(4 * n_words, b"\0"))
    for start in range(0, n_words - 3, 3):
        a, b, c = (x + words[start + k] & _MASK for k, x in enumerate((a, b, c)))
        a, b, c = _mix(a, b, c)
    a, b, c = (x + words[n_words - 3 + k] & _MASK for k, x in enumerate((a, b, c)))
    return _final(a, b, c)


def _rotate(x: int, k: int) -> int:
    return ((x << k) | (x >> (32 - k))) & _MASK


def _mix(a: int, b: int, c: int) -> tuple[int, int, int]:
    for k in (4, 6, 8, 16, 19, 4):
        a = ((a - c) & _MASK) ^ _rotate(c, k)
        c = (c + b) & _MASK
        a, b, c = b, c, a
    return a, b, c


def _final(a: int, b: int, c: int) -> int:
    for k in (14, 11, 25, 16, 4, 14, 24):
        c = ((c ^ b) - _rotate(b, k)) & _MASK
        a, b, c = b, c, a
    # seven steps of a rotation by three leave the result one place to the left
    return b


@dataclass(frozen=True)
class Superblock:
    """What a file's first bytes say.

    Attributes:
        is_sound: Version 3, and its checksum is right.
        says_written: A writer has the file open, or died while it had.
        end: Where the file ended when it was last closed.
    """

    is_sound: bool
    says_written: bool
    end: int


def read_superblock(path: Path) -> Superblock | None:
    """Return what stands there, None where it is not HDF5's or of another version than 3."""
    with path.open("rb") as file:
        block = file.read(SUPERBLOCK_BYTES)
    if not block.startswith(_SIGNATURE) or block[8:9] not in (b"", b"\3"):
        return None
    if len(block) < SUPERBLOCK_BYTES:
        return Superblock(is_sound=False, says_written=False, end=0)
    fields = _SUPERBLOCK.unpack(block[: _SUPERBLOCK.size])
    checksum = _CHECKSUM.unpack(block[_SUPERBLOCK.size :])[0]
    is_sound = checksum == lookup3(block[: _SUPERBLOCK.size])
    return Superblock(is_sound, says_written=fields[4] != 0, end=fields[7])


def as_closed(block: bytes, *, end: int) -> bytes:
    """Return the superblock `block` with its flags cleared, for a file that ends at `end`."""
    fields = list(_SUPERBLOCK.unpack(block[: _SUPERBLOCK.size]))
    fields[4], fields[7] = 0, end
    closed = _SUPERBLOCK.pack(*fields)
    return closed + _CHECKSUM.pack(lookup3(closed))


def give_back_unused(path: Path) -> None:
    """Cut what stands behind the end of a properly closed file: room asked for and not used."""
    with path.open("r+b") as file:
        fields = _SUPERBLOCK.unpack(file.read(_SUPERBLOCK.size))
        consistency_flags, end = fields[4], fields[7]
        if consistency_flags == 0 and end < os.fstat(file.fileno()).st_size:
            os.ftruncate(file.fileno(), end)


def mark_as_closed(path: Path, *, reserve_bytes: int) -> bool:
    """Make `path` openable for writing again; return False where it was closed properly.

    The caller must know that no other process writes it. `reserve_bytes` are added at the end, as
    a hole: metadata that reached the disk may speak of space that the dead writer had not yet used.
    """
    with disk_errors(path), path.open("r+b") as file:
        block = file.read(_SUPERBLOCK.size)
        if len(block) < _SUPERBLOCK.size or not block.startswith(_SIGNATURE) or block[8] != 3:
            raise InputError(
                f"{path} is not a recording of darkflat: its HDF5 superblock is not version 3",
                code="not-a-recording",
            )
        if _SUPERBLOCK.unpack(block)[4] == 0:
            return False
        size = os.fstat(file.fileno()).st_size + reserve_bytes
        os.ftruncate(file.fileno(), size)
        file.seek(0)
        file.write(as_closed(block, end=size))
        file.flush()
        os.fsync(file.fileno())
    return True
