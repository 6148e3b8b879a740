"""The bench's process as its parent has it: started, told, heard, and ended."""

import logging
import multiprocessing
import threading
from collections.abc import Callable
from contextlib import suppress

from service.bench.settings import BenchSettings
from service.owner.bench_process import serve_bench
from service.owner.messages import Command, Leave, Report

_LOG = logging.getLogger(__name__)


class Child:
    """One life of the process. Only the thread that hears it waits for its end.

    Of two that wait for one process, one learns of its end and the other that there is none.

    Attributes:
        pid: Of the process.
    """

    def __init__(
        self, settings: BenchSettings, take: Callable[[Report], None], ended: Callable[[], None]
    ) -> None:
        """Start it; `take` is told every report and `ended` its end, in a thread of this one's."""
        self._take = take
        self._ended = ended
        context = multiprocessing.get_context("spawn")  # forking a threaded server deadlocks
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=serve_bench, args=(settings, theirs), name="darkflat-bench"
        )
        self._process.start()
        theirs.close()
        self.pid = self._process.pid
        self._reports = threading.Thread(
            target=self._listen, name="darkflat-bench-reports", daemon=True
        )
        self._reports.start()

    def send(self, command: Command) -> None:
        """Tell it something; OSError where it has ended."""
        self._pipe.send(command)

    def end(self, within_s: float) -> None:
        """Have it close the bench and end, or kill it; return once its end was heard."""
        with suppress(OSError):  # it has ended by itself
            self.send(Leave())
        self._reports.join(within_s)
        if self._reports.is_alive():
            _LOG.error("the bench's process does not end; it is killed, look at the lamps")
            self._process.kill()
            self._reports.join(within_s)

    def _listen(self) -> None:
        while True:
            try:
                report: Report = self._pipe.recv()
            except (EOFError, OSError):
                break
            self._take(report)
        self._process.join()
        self._ended()
