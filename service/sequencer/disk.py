"""Is there room for the recording?"""

import shutil
from pathlib import Path

from service.sequencer.errors import RunRefusedError


def check_room(out: Path, n_bytes: int) -> None:
    """Raise RunRefusedError, code `disk-full`, when `n_bytes` do not fit where `out` goes."""
    folder = out.absolute().parent
    if not folder.is_dir():
        msg = f"the folder {folder} for the recording does not exist; make it first"
        raise RunRefusedError(msg, code="no-such-folder")
    free = shutil.disk_usage(folder).free
    if free < n_bytes:
        msg = (
            f"the recording needs {n_bytes / 1e6:.1f} MB, but {folder} has {free / 1e6:.1f} MB"
            " left; free some room or choose another folder"
        )
        raise RunRefusedError(msg, code="disk-full")
