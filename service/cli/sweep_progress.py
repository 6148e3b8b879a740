"""How far a sweep is, for the one who waits: the sequencer says how long it still takes.

The share of blocks does not say it: they differ in length, and some were done before a resume.
"""

from service.cli.progress import Report
from service.sequencer.events import OnProgress, Progress


def sweep_progress(report: Report, *, first: float = 0.0, last: float = 1.0) -> OnProgress:
    """Return what tells `report` of a run that is the work from the share `first` to `last`."""

    def tell(at: Progress) -> None:
        share = at.blocks_done / max(1, at.blocks_total)
        report(first + (last - first) * share, at.doing, at.seconds_left)

    return tell
