"""A recording's name by its content: the same for a file and its exported folder."""

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

from calib.arrays import RawLines
from calib.recording.behind import Behind
from calib.recording.header import RecordingHeader
from calib.recording.protocol import Recording

_FRAMES_BEHIND = 3

# Says only how headerless frames are stored.
_NOT_CONTENT = {"dtype"}


def digest_of(recording: Recording) -> str:
    """Return SHA-256 (hex) over the canonical header and, block by block, the codes.

    The header is JSON with sorted keys, unknown keys included, unknown values left out; the codes
    are uint8 or little-endian uint16 in C order, with the number of lines behind each block.
    """
    sha = hashlib.sha256(_canonical_header(recording.header))
    for block in recording.header.blocks:
        n_lines = 0
        for dn in recording.frames(block.block):
            sha.update(dn.data)
            n_lines += len(dn)
        sha.update(_end_of(block.block, n_lines))
    return sha.hexdigest()


class DigestedWhileRead:
    """A recording whose digest comes along while its frames are read for something else.

    The hash is worked out in a thread, a few frames behind. Where the blocks were not read each to
    its end and in their order, `digest` reads them itself.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self._sha = hashlib.sha256(_canonical_header(recording.header))
        self._names = [block.block for block in recording.header.blocks]
        self._n_digested = 0
        self._broken_off = False
        self._behind = Behind(_FRAMES_BEHIND)

    @property
    def path(self) -> Path:
        """The .h5 file or the folder."""
        return self._recording.path

    @property
    def header(self) -> RecordingHeader:
        """Camera, source and blocks."""
        return self._recording.header

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was odd but usable."""
        return self._recording.warnings

    def frames(self, block: str) -> Iterator[RawLines]:
        """Yield the block's codes, and digest them if it is this block's turn."""
        frames = self._recording.frames(block)
        is_next = self._names[self._n_digested : self._n_digested + 1] == [block]
        return self._digested(block, frames) if is_next and not self._broken_off else frames

    def digest(self) -> str:
        """SHA-256 over header and frames."""
        self._behind.catch_up()
        whole = self._n_digested == len(self._names) and not self._broken_off
        return self._sha.hexdigest() if whole else self._recording.digest()

    def _digested(self, block: str, frames: Iterator[RawLines]) -> Iterator[RawLines]:
        self._broken_off = True  # until the end is reached
        n_lines = 0
        for dn in frames:
            self._behind.submit(self._sha.update, dn.data)
            n_lines += len(dn)
            yield dn
        self._behind.submit(self._sha.update, _end_of(block, n_lines))
        self._n_digested += 1
        self._broken_off = False


def _end_of(block: str, n_lines: int) -> bytes:
    return f"\n{block} {n_lines}\n".encode()


def _canonical_header(header: RecordingHeader) -> bytes:
    content = header.model_dump(mode="json", exclude={"camera"}, exclude_none=True)
    camera = header.camera.content()
    content["camera"] = {name: camera[name] for name in camera if name not in _NOT_CONTENT}
    return json.dumps(content, sort_keys=True, separators=(",", ":")).encode()
