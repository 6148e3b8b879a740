"""Errors about what was uploaded name files as the client knows them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from calib.errors import InputError, NotDeterminedError


@contextmanager
def names_of_the_archive(*folders: Path) -> Iterator[None]:
    """Leave out of errors where the archive was unpacked on this machine."""
    try:
        yield
    except (InputError, NotDeterminedError) as error:
        text = str(error)
        for folder in folders:
            text = text.replace(f"{folder}/", "").replace(str(folder), "the archive")
        kind = InputError if isinstance(error, InputError) else NotDeterminedError
        raise kind(text, code=error.code) from error
