"""Make every ordinary end of the process close the bench."""

import atexit
import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

_DEFAULTS = {
    signal.SIGTERM: signal.SIG_DFL,
    signal.SIGHUP: signal.SIG_DFL,
    signal.SIGINT: signal.default_int_handler,
}


class Endings:
    """While installed, signals that end the process unwind its stack, and atexit closes the rest.

    A handler that somebody else installed (a web server) stays, and so does everything where this
    is not the main thread: there atexit alone remains.

    Attributes:
        came: The signal that asks the process to end; None before. An exception that is raised
            while a library calls back can get lost there: whoever works for long therefore asks
            `is_ending` as well, and `end` raises it again.
    """

    def __init__(self, close: Callable[[], None]) -> None:
        self.came: int | None = None
        self._close = close
        self._before: dict[signal.Signals, Any] = {}

    @property
    def is_ending(self) -> bool:
        """True once a signal came."""
        return self.came is not None

    def end(self) -> None:
        """End the process the way that runs every `finally`, where a signal asked for it."""
        if self.came == signal.SIGINT:
            raise KeyboardInterrupt
        if self.came is not None:
            raise SystemExit(128 + self.came)  # the shell's status for a signal

    def install(self) -> None:
        """Take over what nobody handles."""
        atexit.register(self._close)
        if threading.current_thread() is not threading.main_thread():
            return
        for number, default in _DEFAULTS.items():
            if signal.getsignal(number) is default:
                self._before[number] = signal.signal(number, self._unwind)

    def remove(self) -> None:
        """Give back what was taken over."""
        atexit.unregister(self._close)
        if threading.current_thread() is threading.main_thread():
            for number, handler in self._before.items():
                signal.signal(number, handler)
            self._before.clear()

    def _unwind(self, number: int, _frame: FrameType | None) -> None:
        self.came = number
        self.end()
