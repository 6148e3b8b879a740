"""Recordings as they are uploaded."""

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

from calib.recording.commit_log import commit_path
from calib.recording.folder import export_folder
from calib.recording.open import open_recording


def packed(files: Mapping[str, bytes]) -> bytes:
    """Return a zip of these files."""
    body = io.BytesIO()
    with zipfile.ZipFile(body, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return body.getvalue()


def as_files(recording: Path) -> bytes:
    """Return the .h5 and its commit record, packed."""
    both = (recording, commit_path(recording))
    return packed({path.name: path.read_bytes() for path in both})


def as_folder(recording: Path, scratch: Path, *, inside: str = "") -> bytes:
    """Return the recording as an exported folder, packed."""
    folder = scratch / "exported"
    export_folder(open_recording(recording), folder)
    files = [path for path in folder.rglob("*") if path.is_file()]
    return packed({f"{inside}{path.relative_to(folder)}": path.read_bytes() for path in files})
