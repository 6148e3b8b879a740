"""What was worked out already: searches come by the same effects at the same links again.

A fit that goes on begins where the one before ended, a search with free laws repeats what the one
without did until the first law is freed, and a name is judged where the search has left it. The
latest are kept, up to a size.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from threading import Lock
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Itself:
    """The very same object as part of a key, which another one of the same contents is not."""

    what: object

    def __eq__(self, other: object) -> bool:
        """Return whether it is the same one."""
        return isinstance(other, Itself) and self.what is other.what

    def __hash__(self) -> int:
        """Return a number of it."""
        return id(self.what)


class Latest(Generic[T]):
    """What was asked for last, by what it follows from."""

    def __init__(self, size: Callable[[T], int], most: int) -> None:
        """Know nothing; keep so much that all sizes make up `most`, and never less than one."""
        self._size, self._most = size, most
        self._known: OrderedDict[Hashable, T] = OrderedDict()
        self._sum, self._lock = 0, Lock()

    def of(self, key: Hashable, made: Callable[[], T]) -> T:
        """Return what follows from that key, made where it is not known."""
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        found = made()
        with self._lock:
            if key not in self._known:
                self._known[key] = found
                self._sum += self._size(found)
            while self._sum > self._most and len(self._known) > 1:
                self._sum -= self._size(self._known.popitem(last=False)[1])
        return found
