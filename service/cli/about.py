"""Which file an error is about, where the work itself does not know."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from calib.errors import DarkflatError, InputError, NotDeterminedError

_OF_THE_OUTPUT = {"output-exists", "output-not-h5"}


@contextmanager
def about(path: Path | str) -> Iterator[None]:
    """Put `path` before what is said of bad input inside, unless it is named there already."""
    try:
        yield
    except (InputError, NotDeterminedError) as error:
        if error.code in _OF_THE_OUTPUT or re.search(
            rf"(?<!\w){re.escape(str(path))}(?!\w)", str(error)
        ):
            raise
        raise DarkflatError(f"{path}: {error}", code=error.code) from error
