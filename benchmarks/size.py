"""How much work a benchmark does, and who it may compare with."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Size:
    """The sizes of the table; tests run the same rows at toy size.

    Attributes:
        n_lines: Lines per frame.
        n_columns: Columns of the camera.
        n_frames: Frames that one call of a sum gets, so that threads are worth their start.
        fit_pixels: Pixels of which the line fit fits every one.
        stack_rows: Rows of an area sensor.
        stack_columns: Its columns.
        stack_frames: Frames of its stack that lie in memory.
        rounds: Turns per contestant.
        recording_s: How long to record.
        recording_mb_s: The rate at which the camera sends.
        folder: Where recordings are put; None for the system's folder of temporary files.
        peers: The Python of the peers' environment; None where it is not to be used.
    """

    n_lines: int = 714
    n_columns: int = 6144
    n_frames: int = 8
    fit_pixels: int = 2000 * 6144
    stack_rows: int = 2056
    stack_columns: int = 2452
    stack_frames: int = 40
    rounds: int = 9
    recording_s: float = 30.0
    recording_mb_s: float = 260.0
    folder: Path | None = None
    peers: Path | None = None

    @property
    def frame_pixels(self) -> int:
        """Pixels of one frame."""
        return self.n_lines * self.n_columns

    @property
    def stack_pixels(self) -> int:
        """Pixels of one frame of the area sensor."""
        return self.stack_rows * self.stack_columns

    @property
    def frame(self) -> str:
        """The frame in words."""
        return f"{self.n_columns} x {self.n_lines}"
