"""Opening an .h5 recording for reading: closed, being written, or abandoned by a killed writer."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from calib.errors import InputError, reason_of
from calib.recording.abandoned_file import AbandonedFile
from calib.recording.commit_log import commit_path, is_being_written
from calib.recording.superblock import Superblock, read_superblock

_TRIES = 3


@contextmanager
def open_for_reading(path: Path, *, nobody_writes: bool = False) -> Iterator[h5py.File]:
    """Give the file at `path`; InputError says what is wrong with it, then or while it is read.

    Args:
        path: The .h5 file.
        nobody_writes: The caller holds the lock on the commit record.
    """
    try:
        with _opened(path, nobody_writes) as file:
            yield file
    except FileNotFoundError as error:
        raise not_found(path) from error
    except PermissionError as error:
        raise InputError(
            f"{path} cannot be read ({reason_of(error)}): get the right to read it",
            code="recording-unreadable",
        ) from error
    except (OSError, RuntimeError, KeyError, ValueError) as error:  # h5py's, for damage
        raise unreadable(path, error) from error


def not_found(path: Path) -> InputError:
    """Return the InputError for a recording that is not there."""
    return InputError(
        f"there is no recording {path}: name an .h5 file or a recording folder",
        code="recording-not-found",
    )


def unreadable(path: Path, error: Exception) -> InputError:
    """Return the InputError for an HDF5 file that cannot be read."""
    if "truncated" in str(error):
        return InputError(
            f"{path} is truncated: copy it again from where it was recorded",
            code="recording-truncated",
        )
    return InputError(
        f"{path} is not a readable recording ({str(error).splitlines()[0]}): restore it"
        " from a copy",
        code="recording-unreadable",
    )


def _opened(path: Path, nobody_writes: bool) -> h5py.File:
    block = _superblock(path)
    if block is None:
        return h5py.File(path, "r", locking=False)
    if not block.is_sound:
        raise OSError("its first bytes are damaged")
    if not block.says_written:
        if path.stat().st_size < block.end:
            raise OSError("truncated")
        return h5py.File(path, "r", libver="latest", locking=False)
    if not nobody_writes and is_being_written(commit_path(path)):
        return h5py.File(path, "r", libver="latest", swmr=True, locking=False)
    return h5py.File(AbandonedFile(path), "r", libver="latest")


def _superblock(path: Path) -> Superblock | None:
    """Read it again where it looks damaged: its writer may have been at it."""
    for _ in range(_TRIES):
        block = read_superblock(path)
        if block is None or block.is_sound:
            break
        time.sleep(0.001)
    return block
