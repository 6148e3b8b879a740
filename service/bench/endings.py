"""Make every ordinary end of the process close the bench."""

import atexit
import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any, NoReturn

_ENDING = (signal.SIGTERM, signal.SIGHUP)


class Endings:
    """While installed, SIGTERM and SIGHUP unwind the stack, and atexit closes what is left open.

    SIGINT unwinds it anyway. A handler that somebody else installed (a web server) stays, and so
    does everything where this is not the main thread: there atexit alone remains.
    """

    def __init__(self, close: Callable[[], None]) -> None:
        self._close = close
        self._before: dict[signal.Signals, Any] = {}

    def install(self) -> None:
        """Take over what nobody handles."""
        atexit.register(self._close)
        if threading.current_thread() is not threading.main_thread():
            return
        for number in _ENDING:
            if signal.getsignal(number) is signal.SIG_DFL:
                self._before[number] = signal.signal(number, _unwind)

    def remove(self) -> None:
        """Give back what was taken over."""
        atexit.unregister(self._close)
        if threading.current_thread() is threading.main_thread():
            for number, handler in self._before.items():
                signal.signal(number, handler)
            self._before.clear()


def _unwind(number: int, _frame: FrameType | None) -> NoReturn:
    """End the process the way that runs every `finally`; the shell's own status for a signal."""
    raise SystemExit(128 + number)
