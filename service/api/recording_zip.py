"""A recording on its way out: a zip of its files, as `POST /v1/recordings` takes them."""

import zipfile
from collections.abc import Iterator
from pathlib import Path

from calib.recording.commit_log import commit_path
from service.api.sink import Sink
from service.store.errors import NotInStoreError
from service.store.records import RecordingRecord

_CHUNK = 1 << 20


def files_of(record: RecordingRecord) -> dict[str, Path]:
    """Return the recording's files by their names in the archive; NotInStoreError if gone."""
    path, stem = Path(record.path), record.digest[:12]
    if path.is_dir():
        found = {
            f"{stem}/{file.relative_to(path)}": file
            for file in sorted(path.rglob("*"))
            if file.is_file() and not file.is_symlink()
        }
    else:
        found = {f"{stem}.h5": path, f"{stem}.frames.jsonl": commit_path(path)}
    if not found or not all(file.is_file() for file in found.values()):
        msg = f"the files of recording {record.digest[:12]} are gone; see darkflat store check"
        raise NotInStoreError(msg)
    return found


def zipped(files: dict[str, Path]) -> Iterator[bytes]:
    """Yield the bytes of a zip in constant memory; frames are noise, and not compressed."""
    sink = Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED) as archive:
        for name, path in files.items():
            member = zipfile.ZipInfo(name)
            member.external_attr = 0o644 << 16
            with path.open("rb") as source, archive.open(member, "w", force_zip64=True) as packed:
                while chunk := source.read(_CHUNK):
                    packed.write(chunk)
                    yield sink.fetch()
    yield sink.fetch()
