"""Recordings: uploaded, listed, inspected, downloaded, deleted."""

from collections.abc import Iterator
from pathlib import Path

from calib.errors import InputError
from calib.recording.commit_log import commit_path
from service.api.answers.recording import RecordingAnswer, RecordingPage
from service.client.link import Link
from service.client.packing import ZIP, in_folder, packed

_PLACE = "/v1/recordings"


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
        with packed(Path(recording), _files) as archive:
            return self._link.post(
                RecordingAnswer,
                _PLACE,
                params={"name": name},
                content=archive,
                headers=ZIP,
            )

    def get(self, digest: str) -> RecordingAnswer:
        """Inspect a recording."""
        return self._link.get(RecordingAnswer, f"{_PLACE}/{digest}")

    def all(
        self, *, serial: str | None = None, band: str | None = None
    ) -> Iterator[RecordingAnswer]:
        """Yield every recording, newest first."""
        return self._link.pages(RecordingPage, _PLACE, serial=serial, band=band)

    def download(self, digest: str, out: Path | str) -> Path:
        """Write a recording to `out`: a zip, as `upload` takes it."""
        return self._link.download(f"{_PLACE}/{digest}/file", out)

    def delete(self, digest: str) -> None:
        """Delete a recording for good.

        Raises:
            ProblemError: `recording-in-use` while a coefficient set, a run or a job needs it.
        """
        self._link.ask("DELETE", f"{_PLACE}/{digest}")


def _files(recording: Path) -> dict[str, Path]:
    if (recording / "recording.toml").is_file():
        return in_folder(recording)
    both = (recording, commit_path(recording))
    if recording.suffix == ".h5" and all(path.is_file() for path in both):
        return {path.name: path for path in both}
    msg = f"{recording} is no recording: name an .h5 beside its .frames.jsonl, a recording folder,"
    msg += " or a .zip of one"
    raise InputError(msg, code="not-a-recording")
