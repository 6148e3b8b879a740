"""Recordings: each record's files hold the content that its digest names."""

from collections.abc import Iterator
from pathlib import Path

from calib.errors import InputError
from calib.recording.commit_log import commit_path
from service.store.check.finding import Finding, Kind
from service.store.records import RecordingRecord


def check_recording(record: RecordingRecord) -> Iterator[Finding]:
    """Read a recording with all its frames, and compare it with its digest."""
    from calib.recording.open import open_recording  # noqa: PLC0415  (slow to import)

    path, name = Path(record.path), f"recording {record.digest[:12]} ({record.name})"
    is_file = path.suffix == ".h5"
    for needed in (path, commit_path(path)) if is_file else (path,):
        if not needed.exists():
            text = f"{needed} of {name} is gone; put it back, or make a copy of it known anew"
            yield Finding(Kind.MISSING, record.digest, needed, text)
            return
    try:
        digest = open_recording(path).digest()
    except InputError as error:
        yield Finding(Kind.ALTERED, record.digest, path, f"{error} ({name})")
        return
    if digest != record.digest:
        text = (
            f"{path} is not what was known as {name}: its digest is {digest[:12]} now; restore it"
        )
        yield Finding(Kind.ALTERED, record.digest, path, text)
