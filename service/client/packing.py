"""What is uploaded goes as a zip."""

import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO

ZIP = {"Content-Type": "application/zip"}
_AT_ONCE_BYTES = 1 << 20


@contextmanager
def packed(
    source: Path, files_of: Callable[[Path], Mapping[str, Path]]
) -> Iterator[Iterator[bytes]]:
    """Give the archive of what `files_of` finds at `source`, by pieces; a .zip goes as it is."""
    if source.suffix == ".zip" and source.is_file():
        with source.open("rb") as archive:
            yield pieces(archive)
        return
    files = files_of(source)
    with tempfile.TemporaryFile() as archive:
        # Frames hardly shrink, and the bench's network is quicker than deflating them.
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as packing:
            for name, file in files.items():
                packing.write(file, name)
        archive.seek(0)
        yield pieces(archive)


def pieces(file: IO[bytes]) -> Iterator[bytes]:
    """Yield the rest of a file, a megabyte at once."""
    return iter(lambda: file.read(_AT_ONCE_BYTES), b"")


def in_folder(folder: Path) -> dict[str, Path]:
    """Return every file under a folder, by its name in the archive."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path for path in files}
