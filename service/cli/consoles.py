"""Where people read: answers on standard output, progress on standard error."""

import sys

from rich.console import Console


def output() -> Console:
    """Return the console of answers."""
    return Console(file=sys.stdout, highlight=False, soft_wrap=True)


def notes() -> Console:
    """Return the console of progress and remarks."""
    return Console(file=sys.stderr, highlight=False, soft_wrap=True)
