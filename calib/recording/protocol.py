"""A recording as every reader sees it, whatever file it lives in."""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

from calib.arrays import RawLines
from calib.recording.header import RecordingHeader


class Recording(Protocol):
    """Reads frames in the order in which they were taken; memory does not grow with its size."""

    @property
    def path(self) -> Path:
        """The .h5 file or the folder."""
        ...

    @property
    def header(self) -> RecordingHeader:
        """Camera, source and blocks."""
        ...

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was odd but usable: unknown keys, salvaged tails; one sentence each."""
        ...

    def frames(self, block: str) -> Iterator[RawLines]:
        """Yield the block's codes: stretches of lines, (n_lines, n_columns), or area frames."""
        ...

    def digest(self) -> str:
        """SHA-256 over header and frames, the same for a file and its exported folder."""
        ...
