"""The folder of each recording that was uploaded: put there whole, taken away whole."""

import shutil
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from calib.recording.durable import sync
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store

FILE = "recording.h5"
FILES_LOCK = threading.Lock()
"""Held from settling files to putting them on record, and from taking a recording off the record
to taking its files away: what comes in again meanwhile keeps its files."""
_ARRIVING = "arriving-"


def settle(kept: Path, home: Path) -> None:
    """Bring the files in `kept` to the disk, then the folder to `home`, if that is not there."""
    for file in kept.iterdir():
        sync(file)
    home.parent.mkdir(parents=True, exist_ok=True)
    if home.exists():  # the name is the content's digest: it is the same recording
        shutil.rmtree(kept)
        return
    kept.rename(home)
    sync(home.parent)


@contextmanager
def arriving(home: Path, settings: Settings) -> Iterator[None]:
    """Settle files at `home` and put them on record inside; who dies there leaves a note of it."""
    if home.exists():
        yield
        return
    note = settings.work_folder / f"{_ARRIVING}{home.name}"
    note.touch()
    yield
    note.unlink()


def take_back(settings: Settings, store: Store) -> None:
    """Take away what was arriving when a service was killed: no record names it, nobody was told.

    The notes go with all else that it had under way.
    """
    for note in settings.work_folder.glob(f"{_ARRIVING}*"):
        digest = note.name.removeprefix(_ARRIVING)
        if not store.recordings.knows(digest):
            shutil.rmtree(settings.recordings_folder / digest, ignore_errors=True)


def delete_recording(digest: str, *, by: Actor, settings: Settings, store: Store) -> None:
    """Forget a recording that nothing refers to, and delete what was uploaded of it.

    A file that was only made known where it is stays there. Whoever dies in between leaves files
    that nobody knows, never a record without files.

    Raises:
        NotInStoreError: It is unknown.
        StoreError: `recording-in-use`.
    """
    with FILES_LOCK, tempfile.TemporaryDirectory(dir=settings.work_folder, prefix="del-") as gone:
        record = store.recordings.remove(digest, by=by)
        home = settings.recordings_folder / record.digest
        if home.is_dir():
            home.rename(Path(gone) / record.digest)
            sync(home.parent)
