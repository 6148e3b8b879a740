"""A new recording file and its commit record: both when all went well, neither when not."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from calib.recording.commit_log import check_ending, commit_path
from calib.recording.durable import (
    disk_errors,
    in_new_parents,
    partial_path,
    refuse_existing,
)


@contextmanager
def new_recording(out: Path) -> Iterator[Path]:
    """Give a hidden path to write to, which becomes `out`.

    Raises:
        InputError: `output-exists`, `output-not-h5`.
        DarkflatError: `cannot-write`, `disk-full`.
    """
    check_ending(out)
    partial = partial_path(out)
    remains = [partial, commit_path(partial)]
    refuse_existing(out)
    if _was_killed_while_renaming(out, partial):
        remains.append(commit_path(out))
    else:
        refuse_existing(commit_path(out))
    with in_new_parents(out):
        try:
            with disk_errors(out):
                for each in reversed(remains):
                    each.unlink(missing_ok=True)
            yield partial
            with disk_errors(out):
                # A recording without its commit record must never be seen, so that comes first.
                commit_path(partial).rename(commit_path(out))
                partial.rename(out)
        finally:
            for each in (partial, commit_path(partial)):
                with suppress(OSError):
                    each.unlink()


def _was_killed_while_renaming(out: Path, partial: Path) -> bool:
    """Tell whether `out`'s commit record is there alone because the second rename never came.

    Its file is then still under the hidden name, and that name's record is gone. A record alone
    without these traces belongs to a file that somebody moved away, and must not be lost.
    """
    return commit_path(out).exists() and partial.exists() and not commit_path(partial).exists()
