"""A recording that was uploaded becomes one of ours: `recordings/<digest>/recording.h5`."""

import tempfile
from pathlib import Path

from calib.errors import InputError
from calib.recording.commit_log import commit_path
from calib.recording.folder import import_folder
from calib.recording.open import open_recording
from service.api.archive_names import names_of_the_archive
from service.api.hdf5_safety import check_self_contained
from service.api.recording_files import FILE, FILES_LOCK, arriving, settle
from service.api.unpacking import unpack
from service.settings import Settings
from service.store.actor import Actor
from service.store.records import RecordingRecord
from service.store.store import Store


def import_archive(
    archive: Path, *, name: str, by: Actor, settings: Settings, store: Store
) -> tuple[RecordingRecord, bool]:
    """Unpack, check and keep the recording in the zip file `archive`; say whether it is a new one.

    Raises:
        InputError: What is wrong with it; nothing is kept then.
    """
    with tempfile.TemporaryDirectory(dir=settings.work_folder, prefix="import-") as folder:
        unpacked, kept = Path(folder) / "unpacked", Path(folder) / "kept"
        kept.mkdir()
        unpack(archive, unpacked, settings)
        with names_of_the_archive(unpacked, kept):
            _take(unpacked, kept / FILE)
        digest = open_recording(kept / FILE).digest()
        home = settings.recordings_folder / digest
        with FILES_LOCK, arriving(home, settings):
            settle(kept, home)
            is_new = not store.recordings.knows(digest)
            record = store.recordings.register(
                open_recording(home / FILE), name=name or digest[:12], by=by, digest=digest,
                action="import",
            )  # fmt: skip
    return record, is_new


def _take(unpacked: Path, out: Path) -> None:
    """Make the one recording under `unpacked` the file `out`."""
    folders = list(unpacked.rglob("recording.toml"))
    files = list(unpacked.rglob("*.h5"))
    if len(folders) == 1 and not files:
        import_folder(folders[0].parent, out)
    elif len(files) == 1 and not folders:
        check_self_contained(files[0])
        if not commit_path(files[0]).is_file():
            msg = f"{files[0].name} comes without its commit record; pack both files"
            raise InputError(msg, code="no-commit-record")
        commit_path(files[0]).rename(commit_path(out))
        files[0].rename(out)
    else:
        msg = "the archive does not hold exactly one recording: a folder with recording.toml,"
        msg += " or an .h5 with its .frames.jsonl"
        raise InputError(msg, code="not-a-recording")
