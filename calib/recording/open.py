"""Opening a recording, whatever it lives in."""

from pathlib import Path

from calib.errors import InputError
from calib.recording.file_recording import FileRecording
from calib.recording.folder_recording import FolderRecording
from calib.recording.protocol import Recording


def open_recording(path: Path | str) -> Recording:
    """Return the recording in an .h5 file or a folder; InputError says why it cannot be read."""
    path = Path(path)
    if path.is_dir():
        return FolderRecording(path)
    if path.name.endswith(".frames.jsonl"):
        raise InputError(
            f"{path} is a commit record: name the .h5 file beside it", code="not-a-recording"
        )
    return FileRecording(path)
