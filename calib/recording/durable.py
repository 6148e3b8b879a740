"""Writing so that nothing half-written is ever seen under its final name."""

import errno
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from calib.errors import DarkflatError, InputError

_PARTIAL = ".partial-"
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


class DiskFullError(DarkflatError):
    """The disk took no more; what was acknowledged before stays."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"no space left to write {_final(path)}: free some, then start again (or resume)",
            code="disk-full",
        )


def is_disk_full(error: OSError) -> bool:
    """Tell whether `error` means a full disk; HDF5 names the errno in its text alone."""
    in_text = re.search(r"errno = (\d+)", str(error))
    return error.errno in _FULL or (in_text is not None and int(in_text[1]) in _FULL)


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turn the system's answers about `path` into one sentence: full, or not to be written."""
    try:
        yield
    except OSError as error:
        if is_disk_full(error):
            raise DiskFullError(path) from error
        raise DarkflatError(
            f"cannot write {_final(path)} ({error.strerror or error}): name an output in a folder"
            " that takes it",
            code="cannot-write",
        ) from error


def partial_path(path: Path) -> Path:
    """Where `path` is written before it gets its name: the same folder, hidden."""
    return path.with_name(f"{_PARTIAL}{path.name}")


def _final(path: Path) -> Path:
    """Return the name that `path` gets in the end: the only one that its reader knows."""
    return path.with_name(path.name.replace(_PARTIAL, ""))


def refuse_existing(*paths: Path) -> None:
    """Raise InputError `output-exists` when one of `paths` is there already."""
    for path in paths:
        if path.exists():
            raise InputError(
                f"{path} exists already: name another output, or move it away",
                code="output-exists",
            )


def sync(path: Path) -> None:
    """Return once the contents of the file or folder `path` are on the disk itself."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_whole(path: Path, content: bytes) -> None:
    """Write `content` to `path`, on the disk itself before this returns, or leave all as it was."""
    partial = partial_path(path)
    try:
        with disk_errors(path):
            partial.write_bytes(content)
            sync(partial)
            partial.replace(path)
            sync(path.parent)
    finally:
        with suppress(OSError):
            partial.unlink()


@contextmanager
def in_new_parents(path: Path) -> Iterator[None]:
    """Make the folders above `path`; where the work fails, those made here vanish again."""
    missing = [each for each in path.parents if not each.exists()]
    nearest = next(each for each in path.parents if each.exists())
    if not nearest.is_dir():
        raise DarkflatError(
            f"cannot write {path}: {nearest} is no folder, name another output", code="cannot-write"
        )
    try:
        with disk_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for each in missing:
            with suppress(OSError):
                each.rmdir()
        raise


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """Give a folder that becomes `path` when all went well, and vanishes when not."""
    if not (path.is_dir() and not any(path.iterdir())):  # an empty one is replaced
        refuse_existing(path)
    partial = partial_path(path)
    with in_new_parents(path):
        try:
            with disk_errors(path):
                shutil.rmtree(partial, ignore_errors=True)
                partial.mkdir()
                yield partial
                for each in sorted(partial.rglob("*")):
                    sync(each)
                partial.rename(path)
                sync(path.parent)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
