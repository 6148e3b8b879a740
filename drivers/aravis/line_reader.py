"""Lines that another process writes, awaited with a deadline."""

import queue
import threading
from typing import IO


class LineReader:
    """Reads `stream` in a thread of its own until it ends."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream
        self._lines: queue.Queue[str] = queue.Queue()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def next(self, timeout_s: float) -> str:
        """Return the next line without its end; empty where none came in time, or none will."""
        try:
            return self._lines.get(timeout=timeout_s)
        except queue.Empty:
            return ""

    def join(self) -> None:
        """Return once the stream has ended."""
        self._thread.join()

    def _read(self) -> None:
        for line in self._stream:
            self._lines.put(line.strip())
        self._lines.put("")
