"""How many frames came, over all runs since the start: a counter that only grows."""

from service.sequencer.events import Progress


class FrameCount:
    """Adds up what runs say of their attempts. Used by one thread, read by any.

    Attributes:
        kept: Whole frames committed.
        lost: Frames lost and taken again.
    """

    def __init__(self) -> None:
        self.kept = self.lost = 0
        self._attempt = (0, 0)

    def begin(self) -> None:
        """Another attempt begins, which counts from 0."""
        self._attempt = (0, 0)

    def take(self, progress: Progress) -> None:
        """Add what came since the attempt last said something."""
        kept, lost = self._attempt
        self.kept += max(progress.frames - kept, 0)
        self.lost += max(progress.lost_frames - lost, 0)
        self._attempt = (max(progress.frames, kept), max(progress.lost_frames, lost))
