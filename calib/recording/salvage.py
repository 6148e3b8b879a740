"""Reopening a recording for writing after its writer was killed, or closed it early."""

from pathlib import Path

import h5py
import numpy as np

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.commit_log import CommitLog, commit_path, read_commit_lines
from calib.recording.commit_state import CommitState, replay
from calib.recording.file_layout import FileContents, read_contents
from calib.recording.frame_codes import crc32_of
from calib.recording.frame_record import CommittedFrame
from calib.recording.opened import OpenedRecording
from calib.recording.read_access import open_for_reading, unreadable
from calib.recording.superblock import mark_as_closed


def reopen(path: Path) -> OpenedRecording:
    """Return the recording, ready to go on.

    Before anything is changed, every frame that counts is read and its CRC verified. Then a torn
    last line and frames without a commit line are dropped.
    """
    if not path.exists():
        raise InputError(f"there is no recording {path} to resume", code="recording-not-found")
    record = commit_path(path)
    lines = read_commit_lines(record)
    log = CommitLog(record)
    try:
        lines = read_commit_lines(record)  # again: only now nobody else writes
        state = replay(lines.entries, record)
        contents = _verified(path, state)
        log.cut(lines.n_bytes)
        file = _reopened(path, state.n_frames)
    except BaseException:
        log.close()
        raise
    return OpenedRecording(path, file, log, contents.header, state, contents.provenance.plan)


def _verified(path: Path, state: CommitState) -> FileContents:
    with open_for_reading(path, nobody_writes=True) as file:
        contents = read_contents(file, path)
        check_identity(path, contents, state)
        for frame in state.every_frame:
            read_frame(file, frame, path)
    return contents


def check_identity(path: Path, contents: FileContents, state: CommitState) -> None:
    """Raise InputError where file and commit record are not of one recording."""
    if contents.recording_id != state.recording_id:
        raise InputError(
            f"{path} and {commit_path(path).name} belong to different recordings: put each back "
            "beside its own",
            code="commit-record-mismatch",
        )


def read_frame(file: h5py.File, frame: CommittedFrame, path: Path) -> RawLines:
    """Return the frame's real lines; InputError where they are not those that were committed."""
    frames = file["frames"]
    at = f"frame {frame.index} of block {frame.block} in {path}"
    if frame.index >= len(frames):
        raise InputError(
            f"{at} is missing though it was committed: the file is truncated; copy it again from "
            "where it was recorded",
            code="recording-truncated",
        )
    try:
        dn: RawLines = frames[frame.index, : frame.lines]
    except (OSError, RuntimeError) as error:
        raise unreadable(path, error) from error
    if crc32_of(dn) != frame.crc32:
        raise InputError(
            f"{at} is not what was recorded (its CRC-32 differs): restore the file from a copy",
            code="crc-mismatch",
        )
    return dn


def _reopened(path: Path, n_frames: int) -> h5py.File:
    with open_for_reading(path, nobody_writes=True) as file:
        frames = file["frames"]
        reserve_bytes = int(np.prod(frames.chunks)) * frames.dtype.itemsize + (1 << 16)
    mark_as_closed(path, reserve_bytes=reserve_bytes)
    try:
        file = h5py.File(path, "r+", libver="latest", locking=False)
        if len(file["frames"]) > n_frames:
            file["frames"].resize(n_frames, axis=0)
            file.flush()
        file.swmr_mode = True
    except (OSError, RuntimeError) as error:
        raise unreadable(path, error) from error
    return file
