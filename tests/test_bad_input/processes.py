"""Running `darkflat` in circumstances that a test can choose: no room, rights that hold."""

import ctypes
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import AbstractContextManager, chdir, contextmanager, nullcontext
from pathlib import Path

import pytest
from typer.testing import CliRunner

from service.cli.app import app
from tests.service.cli.answers import without_progress

DARKFLAT = Path(sys.executable).with_name("darkflat")

_CAPABILITIES_VERSION = 0x20080522
_OVERRIDING_FILE_RIGHTS = 1 << 1 | 1 << 2  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH


def as_a_process(
    folder: Path, *arguments: object, stdout: int | None = subprocess.PIPE
) -> subprocess.CompletedProcess[str]:
    """Run `darkflat` in `folder`, as a shell would: for what only a process of its own shows."""
    return subprocess.run(
        [DARKFLAT, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, **_places(folder)},
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        timeout=240,
    )


def darkflat(
    folder: Path,
    *arguments: object,
    within: AbstractContextManager[object] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run `darkflat` in `folder` and in this process; only the command itself is run `within`."""
    words = [str(each) for each in arguments]
    with pytest.MonkeyPatch.context() as patch, chdir(folder):
        for name, value in _places(folder).items():
            patch.setenv(name, value)
        patch.setattr(tempfile, "tempdir", None)
        without_progress(patch)
        with within or nullcontext():
            ran = CliRunner().invoke(app, words)
    return subprocess.CompletedProcess(words, ran.exit_code, ran.stdout, ran.stderr)


@contextmanager
def no_file_longer_than(n_bytes: int) -> Iterator[None]:
    """Let writes beyond `n_bytes` of a file fail (EFBIG), as on a disk with no room left."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@contextmanager
def rights_that_count() -> Iterator[None]:
    """Have the rights of files hold for root too: give up, for a while, what overrides them."""
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(_CAPABILITIES_VERSION, 0)
    given = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable; twice
    _checked(libc.capget(header, given))
    fewer = (ctypes.c_uint32 * 6)(*given)
    fewer[0] &= ~_OVERRIDING_FILE_RIGHTS
    _checked(libc.capset(header, fewer))
    try:
        yield
    finally:
        _checked(libc.capset(header, given))


def _places(folder: Path) -> dict[str, str]:
    """The home of the store and the temporary files are beside `folder`."""
    return {"TMPDIR": str(folder.parent), "DARKFLAT_HOME": str(folder.parent)}


def _checked(failed: int) -> None:
    if failed:
        raise OSError(ctypes.get_errno(), "capabilities cannot be changed")
