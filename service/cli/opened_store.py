"""The store, for commands."""

import getpass
from collections.abc import Iterator
from contextlib import contextmanager

from service.settings import Settings
from service.store.store import Store


@contextmanager
def opened_store() -> Iterator[Store]:
    """Open the store that the environment names, and close it."""
    with Store.open(Settings.load()) as store:
        yield store


def who() -> str:
    """Return the name of the person who runs the command, as the system knows it."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"
