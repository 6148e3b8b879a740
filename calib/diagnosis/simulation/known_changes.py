"""Changes that were simulated already: searches come by the same effects at the same links again.

A fit that goes on begins where the one before ended, and a search with free courses repeats what
the one without did until the first course is freed. The latest are kept, up to a size in memory.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable

from calib.diagnosis.statistics.change import Change

MOST_BYTES = 1 << 27
"""Kept at a time."""


class KnownChanges:
    """What was simulated last, by what it follows from."""

    def __init__(self) -> None:
        """Know nothing."""
        self._known: OrderedDict[Hashable, Change] = OrderedDict()
        self._bytes = 0

    def of(self, key: Hashable, simulated: Callable[[], Change]) -> Change:
        """Return the change of that key, simulated where it is not known."""
        if key in self._known:
            self._known.move_to_end(key)
            return self._known[key]
        found = self._known[key] = simulated()
        self._bytes += _size(found)
        while self._bytes > MOST_BYTES and len(self._known) > 1:
            self._bytes -= _size(self._known.popitem(last=False)[1])
        return found


def _size(change: Change) -> int:
    return sum(part.nbytes for part in change.parts())
