"""Starting a recording: both its files get their names only when they can be read."""

import uuid
from pathlib import Path

from calib.errors import InputError
from calib.recording.commit_log import CommitLog, check_ending, commit_path, read_commit_lines
from calib.recording.commit_state import FORMAT, CommitState
from calib.recording.durable import disk_errors, partial_path, refuse_existing, sync
from calib.recording.file_layout import Provenance, create_file
from calib.recording.header import RecordingHeader
from calib.recording.opened import OpenedRecording


def start(
    path: Path, header: RecordingHeader, frame_lines: int, before: Provenance, *, started_ns: int
) -> OpenedRecording:
    """Return the new recording, which has no blocks yet."""
    check_ending(path)
    _refuse_existing_recording(path)
    record, partial = commit_path(path), partial_path(path)
    state = CommitState(uuid.uuid4().hex, last_at_ns=started_ns)
    with disk_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    log = CommitLog(partial_path(record), create=True)
    try:
        log.cut(0)
        log.append(
            {"kind": "recording", "format": FORMAT, "id": state.recording_id, "at_ns": started_ns}
        )
        with disk_errors(path):
            file = create_file(partial, state.recording_id, header, frame_lines, before)
            sync(partial)
            log.sync()
            # An .h5 file without its commit record must never be seen, so that one comes last.
            log.rename(record)
            partial.rename(path)
            sync(path.parent)
    except BaseException:
        log.close()
        partial.unlink(missing_ok=True)
        partial_path(record).unlink(missing_ok=True)
        raise
    return OpenedRecording(path, file, log, header, state, before.plan)


def _refuse_existing_recording(path: Path) -> None:
    refuse_existing(path)
    record = commit_path(path)
    # One that holds nothing but its first line is what a start leaves that was killed.
    if record.exists() and len(read_commit_lines(record).entries) > 1:
        raise InputError(
            f"{record} exists without {path.name}: put that file back, or name another output",
            code="output-exists",
        )
