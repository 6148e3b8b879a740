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
    refuse_existing(out, commit_path(out))
    partial = partial_path(out)
    remains = (partial, commit_path(partial))
    with in_new_parents(out):
        try:
            with disk_errors(out):
                for each in remains:
                    each.unlink(missing_ok=True)
            yield partial
            with disk_errors(out):
                # A recording without its commit record must never be seen, so that comes first.
                commit_path(partial).rename(commit_path(out))
                partial.rename(out)
        finally:
            for each in remains:
                with suppress(OSError):
                    each.unlink()
