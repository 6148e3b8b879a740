"""Asking a person for the cap, on a bench without a shutter."""

import sys
from collections.abc import Callable


def ask_for_cap() -> Callable[[str], None] | None:
    """Return what asks on the terminal; None where nobody sits at one."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return None

    def ask(request: str) -> None:
        print(f"{request} Then press Enter.", file=sys.stderr)  # noqa: T201
        sys.stdin.readline()

    return ask
