"""Times as one writes them on a command line: 12h, 90d, 52w."""

import re
from datetime import timedelta
from typing import Final

import typer

_HOURS: Final = {"h": 1, "d": 24, "w": 168}
_LONGEST_H: Final = 100 * 365 * 24


def parse_duration(text: str) -> timedelta:
    """Return the time that `text` names: a whole number of h(ours), d(ays) or w(eeks).

    >>> parse_duration("90d").days
    90
    """
    found = re.fullmatch(r"([0-9]{1,7})([hdw])", text.strip())
    hours = int(found[1]) * _HOURS[found[2]] if found else 0
    if not 0 < hours <= _LONGEST_H:
        msg = f"{text!r} is no time: write 12h, 90d or 52w, for 100 years at most"
        raise typer.BadParameter(msg)
    return timedelta(hours=hours)
