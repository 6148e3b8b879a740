"""The process that owns the bench, seen from inside.

The main thread runs plans, so that signals unwind it and the lamps go off; another one listens.
Where the service dies, the pipe ends: the run is aborted and the bench closed, lamps off, with
nobody left to ask for it.
"""

import logging
import queue
import signal
import sys
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench.bench import Bench
from service.bench.opening import open_bench
from service.bench.settings import BenchSettings
from service.owner.looking import look_at
from service.owner.messages import (
    Abort,
    Answer,
    Command,
    Ended,
    Leave,
    Look,
    Measure,
    Opened,
    Pause,
    Refused,
    Report,
    Resume,
    SafeOff,
    Said,
    Seen,
    Trouble,
)
from service.plan.model import Plan
from service.sequencer.control import RunControl
from service.sequencer.events import LiveColumns, Progress, RunResult
from service.sequencer.run import run_plan
from service.watching.log import Subject, log_of_child

_LOG = logging.getLogger(__name__)

MOST_COLUMNS = 512
"""Of a live profile: more than a page has dots."""
_DARK_WITHIN_S = 3.0
"""So long a run that is aborted may take to let go of the light before it is read back again."""


def serve_bench(settings: BenchSettings, pipe: Connection) -> None:
    """Open the bench and do what the pipe says until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C at the server is the server's business
    said, subject = _Said(pipe), log_of_child()
    try:
        with open_bench(settings) as bench:
            said.tell(Opened(look_at(bench)))
            _LOG.info("the bench %s is open and dark", settings.id)
            _Owner(bench, pipe, said, subject).serve()
    except DarkflatError as error:
        _LOG.error("the bench %s cannot be opened: %s", settings.id, error)
        said.tell(Refused(Trouble.of(error)))
    except Exception:
        _LOG.exception("the bench's process ends by a defect")
        sys.exit(1)


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


class _Owner:
    def __init__(self, bench: Bench, pipe: Connection, said: _Said, subject: Subject) -> None:
        self._bench = bench
        self._subject = subject
        self._pipe = pipe
        self._said = said
        self._work: queue.SimpleQueue[Measure | None] = queue.SimpleQueue()
        self._control = RunControl()
        self._is_idle = threading.Event()
        self._is_idle.set()

    def serve(self) -> None:
        """Run plans, one after the other, until the pipe ends."""
        threading.Thread(target=self._listen, name="darkflat-bench-pipe", daemon=True).start()
        while (wanted := self._work.get()) is not None:
            self._subject.run = wanted.run_id
            self._measure(wanted)
            self._subject.run = ""

    def _measure(self, wanted: Measure) -> None:
        def columns(seen: LiveColumns) -> None:
            every = -(-seen.mean_dn.size // MOST_COLUMNS)
            self._said.tell(Seen(wanted.run_id, seen.block, seen.mean_dn[::every], every))

        def progress(stands: Progress) -> None:
            self._said.tell(Said(wanted.run_id, stands))

        _LOG.info("measuring into %s", wanted.out.name)
        try:
            result = run_plan(
                self._bench,
                Plan.parse(wanted.plan),
                wanted.out,
                resume=wanted.out.exists(),
                control=self._control,
                on_progress=progress,
                on_columns=columns,
            )
            ended = Ended(wanted.run_id, result=result, digest=_digest(result))
        except DarkflatError as error:
            ended = Ended(wanted.run_id, trouble=Trouble.of(error))
            _LOG.error("the run ended: %s", error)
        except OSError as error:
            ended = Ended(wanted.run_id, trouble=_of_system(error, wanted.out))
            _LOG.error("the run ended: %s", error)
        self._is_idle.set()
        self._said.tell(ended)

    def _listen(self) -> None:
        while True:
            try:
                command: Command = self._pipe.recv()
            except (EOFError, OSError):  # the service died
                break
            if isinstance(command, Leave):
                break
            self._do(command)
        self._control.abort()
        self._work.put(None)

    def _do(self, command: Command) -> None:
        match command:
            case Measure():
                self._control = RunControl()
                self._is_idle.clear()
                self._work.put(command)
            case Pause():
                self._control.pause()
            case Resume():
                self._control.resume()
            case Abort():
                self._control.abort()
            case SafeOff(number):
                self._control.abort()
                self._aside(lambda: self._dark(number))
            case Look(number):
                self._aside(lambda: self._said.tell(Answer(number, look_at(self._bench))))

    def _dark(self, number: int) -> None:
        """Switch off now, and read back when the run has let go: what it had begun may light.

        A run that lets go in time has itself read the lamps back as off. Six supplies on a slow
        line take 1.5 s for that: they are not asked the same thing twice.
        """
        self._bench.last_off = None
        self._bench.light.order_off()
        in_time = self._is_idle.wait(_DARK_WITHIN_S)
        read_back = self._bench.last_off if in_time else None
        look = look_at(self._bench, switching_off=True, light_is=read_back)
        self._said.tell(Answer(number, look))

    def _aside(self, work: Callable[[], None]) -> None:
        threading.Thread(target=work, name="darkflat-bench-aside", daemon=True).start()


def _digest(result: RunResult) -> str:
    return FileRecording(result.path).digest() if result.state == "succeeded" else ""


def _of_system(error: OSError, out: Path) -> Trouble:
    return Trouble("system-error", f"{out.name}: {error.strerror or error}; then resume the run")
