"""Running the real command, as a shell would, in circumstances that a test can choose."""

import ctypes
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

DARKFLAT = Path(sys.executable).with_name("darkflat")

_PR_CAPBSET_DROP = 24
_CAP_DAC_OVERRIDE = 1
_CAP_DAC_READ_SEARCH = 2


def darkflat(
    folder: Path,
    *arguments: object,
    before: Callable[[], object] | None = None,
    stdout: int | None = subprocess.PIPE,
) -> subprocess.CompletedProcess[str]:
    """Run `darkflat` in `folder`, its home and its temporary files beside it."""
    environment = {**os.environ, "TMPDIR": str(folder.parent), "DARKFLAT_HOME": str(folder.parent)}
    return subprocess.run(
        [DARKFLAT, *map(str, arguments)],
        cwd=folder,
        env=environment,
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        preexec_fn=before,
        timeout=120,
    )


def no_file_longer_than(n_bytes: int) -> Callable[[], None]:
    """Let writes beyond `n_bytes` of a file fail (EFBIG), as on a disk with no room left."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, n_bytes))


def rights_count() -> None:
    """Have the rights of files hold for root too."""
    if os.geteuid() == 0:
        libc = ctypes.CDLL(None, use_errno=True)
        for capability in (_CAP_DAC_OVERRIDE, _CAP_DAC_READ_SEARCH):
            if libc.prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0):
                raise OSError(ctypes.get_errno(), "a capability cannot be given up")
