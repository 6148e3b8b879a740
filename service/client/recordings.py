"""Recordings: uploaded, listed, inspected."""

import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from calib.errors import InputError
from calib.recording.commit_log import commit_path
from service.api.answers.recording import RecordingAnswer, RecordingPage
from service.client.link import Link

_ZIP = {"Content-Type": "application/zip"}
_AT_ONCE_BYTES = 1 << 20


class Recordings:
    """`/v1/recordings`."""

    def __init__(self, link: Link) -> None:
        self._link = link

    def upload(self, recording: Path | str, *, name: str = "") -> RecordingAnswer:
        """Upload an .h5 with its commit record, a recording folder, or a zip of one of these.

        A recording that is there already is answered as it is, so this may be done again after
        a lost connection.

        Raises:
            InputError: `not-a-recording`; nothing is sent then.
        """
        with _packed(Path(recording)) as archive:
            return self._link.post(
                RecordingAnswer,
                "/v1/recordings",
                params={"name": name},
                content=iter(lambda: archive.read(_AT_ONCE_BYTES), b""),
                headers=_ZIP,
            )

    def get(self, digest: str) -> RecordingAnswer:
        """Inspect a recording."""
        return self._link.get(RecordingAnswer, f"/v1/recordings/{digest}")

    def all(
        self, *, serial: str | None = None, band: str | None = None
    ) -> Iterator[RecordingAnswer]:
        """Yield every recording, newest first."""
        return self._link.pages(RecordingPage, "/v1/recordings", serial=serial, band=band)


@contextmanager
def _packed(recording: Path) -> Iterator[IO[bytes]]:
    """Give the archive of a recording, open for reading."""
    if recording.suffix == ".zip" and recording.is_file():
        with recording.open("rb") as archive:
            yield archive
        return
    files = _files(recording)
    with tempfile.TemporaryFile() as archive:
        # Frames hardly shrink, and the bench's network is quicker than deflating them.
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as packing:
            for name, file in files.items():
                packing.write(file, name)
        archive.seek(0)
        yield archive


def _files(recording: Path) -> dict[str, Path]:
    if (recording / "recording.toml").is_file():
        files = sorted(path for path in recording.rglob("*") if path.is_file())
        return {str(path.relative_to(recording)): path for path in files}
    both = (recording, commit_path(recording))
    if recording.suffix == ".h5" and all(path.is_file() for path in both):
        return {path.name: path for path in both}
    msg = f"{recording} is no recording: name an .h5 beside its .frames.jsonl, a recording folder,"
    msg += " or a .zip of one"
    raise InputError(msg, code="not-a-recording")
