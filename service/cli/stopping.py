"""Ctrl-C and SIGTERM: the first asks the work to end, lamps off; the second insists."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class StoppedError(BaseException):
    """Raised by a signal; no handler of ordinary errors catches it on its way out."""


class _Wanted:
    """Whether somebody asked for an end, and whether the work looks at that by itself."""

    stop = False
    polled = False


_wanted = _Wanted()


def stop_wanted() -> bool:
    """Return True once somebody asked for an end."""
    return _wanted.stop


@contextmanager
def polled() -> Iterator[None]:
    """While inside, the first signal raises nothing: the work asks `stop_wanted` by itself."""
    _wanted.polled = True
    try:
        yield
    finally:
        _wanted.polled = False


@contextmanager
def stopping() -> Iterator[None]:
    """Take the ending signals over, so that every `finally` runs before the process ends."""
    _wanted.stop = False
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, _signalled) for number in _ENDING}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _signalled(_number: int, _frame: FrameType | None) -> None:
    first = not _wanted.stop
    _wanted.stop = True
    if not (first and _wanted.polled):
        raise StoppedError
