"""What lies in a folder of the store and belongs to no record."""

from collections.abc import Callable, Iterator
from pathlib import Path

from service.store.check.finding import Finding, Kind


def left_over(folder: Path, is_known: Callable[[Path], bool], orphan: str) -> Iterator[Finding]:
    """Yield what lies in `folder` and has no record.

    Args:
        folder: It need not be there.
        is_known: Whether a record names a file or folder.
        orphan: What is said of one that none does; `{path}` is it.
    """
    for path in in_order(folder):
        if path.name.startswith("."):
            text = f"{path} was never finished: its writer was killed (delete it), or writes now"
            yield Finding(Kind.HALF_WRITTEN, path.name, path, text)
        elif not is_known(path):
            yield Finding(Kind.ORPHANED, path.name, path, orphan.format(path=path))


def under_way(folder: Path) -> Iterator[Finding]:
    """Yield what a service works on, or left behind when it was killed."""
    for path in in_order(folder):
        text = f"{path} was never finished: a service works on it now, or was killed; it goes at"
        yield Finding(Kind.HALF_WRITTEN, path.name, path, f"{text} the next start")


def in_order(folder: Path) -> list[Path]:
    """Return what lies in a folder, by name; nothing where there is none."""
    return sorted(folder.iterdir()) if folder.is_dir() else []
