"""Reading an .h5 recording: finished, abandoned by a killed writer, or still being written."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.recording.commit_log import commit_path, read_commit_lines
from calib.recording.commit_state import CommitState, replay
from calib.recording.digest import digest_of
from calib.recording.file_layout import Provenance, check_format, read_contents
from calib.recording.header import RecordingHeader
from calib.recording.read_access import not_found, open_for_reading
from calib.recording.salvage import check_identity, read_frame


class FileRecording:
    """What was committed when it was opened; open it again to see what came since.

    `header.blocks` holds the whole blocks. Every frame's CRC is verified when it is read.
    """

    def __init__(self, path: Path) -> None:
        """Open `path`; InputError says in one sentence why it cannot be read."""
        self._path = path
        if not path.exists():
            raise not_found(path)
        if not commit_path(path).exists():
            with open_for_reading(path, nobody_writes=True) as file:
                check_format(file, path)
        # The commit record first: every frame that it names is then in the file.
        lines = read_commit_lines(commit_path(path))
        self._state = replay(lines.entries, commit_path(path))
        with open_for_reading(path) as file:
            contents = read_contents(file, path)
            n_stored = len(file["frames"])
        check_identity(path, contents, self._state)
        blocks = tuple(recorded.block for recorded in self._state.whole)
        self._header = contents.header.model_copy(update={"blocks": blocks})
        self._before = contents.provenance
        self._frame_lines = contents.frame_lines
        self._warnings = (
            *contents.header_warnings,
            *_oddities(path, self._state, lines.torn, n_stored),
        )

    @property
    def path(self) -> Path:
        """The .h5 file."""
        return self._path

    @property
    def header(self) -> RecordingHeader:
        """Camera, source and whole blocks."""
        return self._header

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was odd but usable; one sentence each."""
        return self._warnings

    @property
    def commits(self) -> CommitState:
        """What the commit record says: every frame's read-backs, lost frames, notes."""
        return self._state

    @property
    def provenance(self) -> Provenance:
        """The plan, the camera's feature dump, the scenes."""
        return self._before

    @property
    def frame_lines(self) -> int:
        """Lines of each frame; the last one of a block may have fewer."""
        return self._frame_lines

    @property
    def scenes(self) -> Mapping[str, NDArray[np.float64]]:
        """Radiance images by name."""
        return self._before.scenes

    def frames(self, block: str) -> Iterator[RawLines]:
        """Yield the block's frames, (n_lines, n_columns), or (n_frames, n_rows, n_columns).

        Raises InputError `crc-mismatch`, naming frame and block, where a frame has changed.
        """
        recorded = next((each for each in self._state.whole if each.block.block == block), None)
        if recorded is None:
            raise InputError(
                f"{self._path} has no whole block {block}: it has "
                f"{', '.join(each.block.block for each in self._state.whole) or 'none'}",
                code="block-not-found",
            )
        with open_for_reading(self._path) as file:
            for frame in recorded.frames:
                yield read_frame(file, frame, self._path)

    def digest(self) -> str:
        """SHA-256 over header and frames, the same for a file and its exported folder."""
        return digest_of(self)


def _oddities(path: Path, state: CommitState, torn: bool, n_stored: int) -> Iterator[str]:
    if torn:
        yield f"{path}: the last line of the commit record is torn; its frame does not count"
    if n_stored > state.n_frames:
        yield f"{path}: {n_stored - state.n_frames} frame(s) without a commit line do not count"
    if state.unfinished is not None:
        name = state.unfinished.block.block
        yield f"{path}: block {name} is unfinished and left out; `sweep --resume` does it again"
    if state.superseded:
        yield f"{path}: {len(state.superseded)} frame(s) of blocks done again are left out"
    if state.lost:
        yield f"{path}: {len(state.lost)} frame(s) did not arrive whole and were taken again"
