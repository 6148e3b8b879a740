"""The folder of each recording that was uploaded: put there whole, taken away whole."""

import shutil
import tempfile
import threading
from pathlib import Path

from calib.recording.durable import sync
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store

FILE = "recording.h5"
FILES_LOCK = threading.Lock()
"""Held from settling files to putting them on record, and from taking a recording off the record
to taking its files away: what comes in again meanwhile keeps its files."""


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
