"""Where people read: answers on standard output, progress on standard error."""

import sys

from rich.console import Console

_WIDTH_OF_A_PIPE = 200
"""Nothing is folded for a reader that has no width."""


def output() -> Console:
    """Return the console of answers."""
    width = None if sys.stdout.isatty() else _WIDTH_OF_A_PIPE
    return Console(file=sys.stdout, highlight=False, soft_wrap=True, width=width)


def notes() -> Console:
    """Return the console of progress and remarks."""
    return Console(file=sys.stderr, highlight=False, soft_wrap=True)
