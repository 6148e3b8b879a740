"""A recording open for writing: its two files, and what they hold so far."""

from dataclasses import dataclass
from pathlib import Path

import h5py

from calib.recording.commit_log import CommitLog
from calib.recording.commit_state import CommitState
from calib.recording.header import RecordingHeader


@dataclass(frozen=True)
class OpenedRecording:
    """The .h5 file in SWMR mode and its commit record, locked."""

    path: Path
    file: h5py.File
    log: CommitLog
    header: RecordingHeader
    state: CommitState
    plan: str
