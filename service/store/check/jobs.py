"""What jobs left for their clients, and what is under way."""

from collections.abc import Iterator
from pathlib import Path

from service.store.check.finding import Finding, Kind


def left_over_jobs(folder: Path, known: set[str]) -> Iterator[Finding]:
    """Yield what lies in the jobs' folder and belongs to no job."""
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name not in known:
            text = f"no job on record left {path}: delete it"
            yield Finding(Kind.ORPHANED, path.name, path, text)


def under_way(folder: Path) -> Iterator[Finding]:
    """Yield what a service works on, or left behind when it was killed."""
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        text = f"{path} was never finished: a service works on it now, or was killed; it goes at"
        yield Finding(Kind.HALF_WRITTEN, path.name, path, f"{text} the next start")
