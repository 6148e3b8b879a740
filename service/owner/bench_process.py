"""The process that owns the bench, seen from inside.

Where the service dies, the pipe ends: the run is aborted and the bench closed, lamps off, with
nobody left to ask for it. Before the lamps are off, nothing is imported that takes long.
"""

import logging
import signal
import sys
import threading
from multiprocessing.connection import Connection

from calib.errors import DarkflatError
from drivers.errors import DeviceBusyError
from service.bench.bench import Bench
from service.bench.opening import open_bench
from service.bench.settings import BenchSettings
from service.owner.looking import look_at
from service.owner.messages import Opened, Refused, Report, Trouble, Waiting
from service.watching.log import log_of_child

_LOG = logging.getLogger(__name__)

_LOOK_AGAIN_S = 0.1
"""For a bench that somebody else has."""


def serve_bench(settings: BenchSettings, pipe: Connection) -> None:
    """Open the bench and do what the pipe says until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C at the server is the server's business
    said, subject = _Said(pipe), log_of_child()
    try:
        bench = _opened(settings, pipe, said)
        if bench is None:
            return
        with bench:
            from service.owner.bench_commands import BenchCommands  # noqa: PLC0415  (takes long)

            said.tell(Opened(look_at(bench)))
            _LOG.info("the bench %s is open and dark", settings.id)
            BenchCommands(bench, pipe, said.tell, subject).serve()
    except DarkflatError as error:
        _LOG.error("the bench %s cannot be opened: %s", settings.id, error)
        said.tell(Refused(Trouble.of(error)))
    except Exception:
        _LOG.exception("the bench's process ends by a defect")
        sys.exit(1)


def _opened(settings: BenchSettings, pipe: Connection, said: "_Said") -> Bench | None:
    """Open the bench as soon as nobody else has it; None where the pipe says something before.

    It may be the process of a service that was killed, which switches off and reads back.
    """
    told = None
    while True:
        try:
            return open_bench(settings)
        except DeviceBusyError as error:
            if error.code != "bench-busy":
                raise
            if told != (told := Trouble.of(error)):
                said.tell(Waiting(told))
        if pipe.poll(_LOOK_AGAIN_S):
            return None


class _Said:
    """The way back: one message at a time, and none once nobody listens."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._lock = threading.Lock()

    def tell(self, report: Report) -> None:
        with self._lock:
            try:
                self._pipe.send(report)
            except OSError:
                return
