"""Does what the service wants of an open bench.

The main thread runs plans, so that signals unwind it and the lamps go off; another one listens.
"""

import logging
import queue
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

from calib.errors import DarkflatError
from calib.recording.file_recording import FileRecording
from service.bench.bench import Bench
from service.owner.looking import look_at
from service.owner.messages import (
    Abort,
    Answer,
    Command,
    Ended,
    Leave,
    Look,
    Measure,
    Pause,
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
from service.watching.log import Subject

_LOG = logging.getLogger(__name__)

MOST_COLUMNS = 512
"""Of a live profile: more than a page has dots."""


class BenchCommands:
    """Hears them until the pipe ends."""

    def __init__(
        self, bench: Bench, pipe: Connection, tell: Callable[[Report], None], subject: Subject
    ) -> None:
        """`tell` is told what comes of them; `subject` is what log lines are about."""
        self._bench = bench
        self._subject = subject
        self._pipe = pipe
        self._tell = tell
        self._work: queue.SimpleQueue[Measure | None] = queue.SimpleQueue()
        self._control = RunControl()

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
            self._tell(Seen(wanted.run_id, seen.block, seen.mean_dn[::every], every))

        def progress(stands: Progress) -> None:
            self._tell(Said(wanted.run_id, stands))

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
        self._tell(ended)

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
        self._bench.light.order_off()  # whatever the run is at: it reads back when it lets go
        self._work.put(None)

    def _do(self, command: Command) -> None:
        match command:
            case Measure():
                self._control = RunControl()
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
                self._aside(lambda: self._tell(Answer(number, look_at(self._bench))))

    def _dark(self, number: int) -> None:
        """Switch off and read back, whatever the run is at.

        What it had begun to set does not go on, and it sets nothing any more: it was told to end.
        """
        self._bench.light.order_off()
        self._tell(Answer(number, look_at(self._bench, switching_off=True)))

    def _aside(self, work: Callable[[], None]) -> None:
        threading.Thread(target=work, name="darkflat-bench-aside", daemon=True).start()


def _digest(result: RunResult) -> str:
    return FileRecording(result.path).digest() if result.state == "succeeded" else ""


def _of_system(error: OSError, out: Path) -> Trouble:
    return Trouble("system-error", f"{out.name}: {error.strerror or error}; then resume the run")
