"""Work that a device does while the RunEngine goes on: Bluesky's `Status`."""

import threading
from collections.abc import Callable


class WorkStatus:
    """Done once its work has ended, well or not. Thread-safe."""

    def __init__(self, work: Callable[[], None], name: str) -> None:
        """Begin `work` in a thread of its own, for drivers block."""
        self._work = work
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._error: BaseException | None = None
        self._callbacks: list[Callable[[WorkStatus], None]] = []
        threading.Thread(target=self._run, name=f"darkflat-{name}", daemon=True).start()

    def add_callback(self, callback: "Callable[[WorkStatus], None]") -> None:
        """Call `callback` with this status when the work has ended; at once where it has."""
        with self._lock:
            if not self._ended.is_set():
                self._callbacks.append(callback)
                return
        callback(self)

    def exception(self, timeout: float | None = 0.0) -> BaseException | None:
        """Return what went wrong, after `timeout` seconds at most; None where nothing did."""
        if not self._ended.wait(timeout):
            raise TimeoutError
        return self._error

    @property
    def done(self) -> bool:
        """Whether the work has ended."""
        return self._ended.is_set()

    @property
    def success(self) -> bool:
        """Whether it has ended well."""
        return self._ended.is_set() and self._error is None

    def wait(self, timeout_s: float) -> None:
        """Return when the work has ended, after `timeout_s` at most."""
        self._ended.wait(timeout_s)

    def _run(self) -> None:
        try:
            self._work()
        except Exception as error:
            self._error = error
        with self._lock:
            self._ended.set()
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)
