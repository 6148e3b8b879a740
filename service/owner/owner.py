"""The process that owns the bench, seen from the service."""

import itertools
import threading
from collections.abc import Callable
from typing import Literal

from calib.errors import DarkflatError
from drivers.errors import DeviceError
from service.bench.settings import BenchSettings
from service.owner.child import Child
from service.owner.messages import (
    DIED,
    Abort,
    Answer,
    BenchLook,
    Command,
    Ended,
    Look,
    Measure,
    Opened,
    Pause,
    Refused,
    Report,
    Resume,
    SafeOff,
    Trouble,
    Waiting,
)

OwnerState = Literal["opening", "idle", "busy", "closed"]
_ANSWER_S = 20.0
_CLOSE_S = 30.0


def _nobody(_: Report) -> None:
    """Whoever comes later looks at the state."""


class BenchOwner:
    """Starts the process, passes on what it says, and starts it anew where it died. Thread-safe.

    Attributes:
        trouble: Why the bench cannot be used; None where it can.
        look: How it was when last asked; None before it was open.
        listener: Told every report but answers, in a thread of the owner's.
    """

    def __init__(
        self, settings: BenchSettings, listener: Callable[[Report], None] = _nobody
    ) -> None:
        self.bench_id = settings.id
        self.trouble: Trouble | None = None
        self.look: BenchLook | None = None
        self._settings = settings
        self.listener = listener
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._answers: dict[int, BenchLook] = {}
        self._changed = threading.Condition(self._lock)
        self._state: OwnerState = "closed"
        self._running = ""
        self._child: Child | None = None

    @property
    def state(self) -> OwnerState:
        """What the process does."""
        return self._state

    @property
    def pid(self) -> int | None:
        """Of the process; None where none was started."""
        child = self._child
        return None if child is None else child.pid

    def check_reachable(self) -> None:
        """Raise the trouble, or DeviceError `bench-not-ready`, where the bench is not open."""
        if self._state in {"opening", "closed"}:
            raise self._not_ready()

    def open(self) -> None:
        """Start the process; the bench is dark once it is `idle`. Nothing where it runs already."""
        with self._lock:
            if self._state != "closed":
                return
            self._child = Child(self._settings, self._take, self._ended)
            self._state, self.trouble = "opening", None

    def measure(self, wanted: Measure) -> None:
        """Begin a run; DeviceError `bench-not-ready` where the bench is not idle."""
        with self._lock:
            if self._state != "idle":
                raise self._not_ready()
            self._state, self._running = "busy", wanted.run_id
        self._send(wanted)

    def pause(self) -> None:
        """Hold the run."""
        self._send(Pause())

    def resume(self) -> None:
        """Let it go on."""
        self._send(Resume())

    def abort(self) -> None:
        """End it."""
        self._send(Abort())

    def safe_off(self) -> BenchLook:
        """End the run, switch every lamp off, and return what was read back."""
        return self._ask(SafeOff(next(self._numbers)))

    def look_now(self) -> BenchLook:
        """Ask every device how it is."""
        return self._ask(Look(next(self._numbers)))

    def close(self) -> None:
        """End the run and the process; the lamps are off then. Safe to call twice."""
        with self._lock:
            child, self._child = self._child, None
        if child is not None:
            child.end(_CLOSE_S)

    def _ask(self, question: SafeOff | Look) -> BenchLook:
        self._send(question)
        with self._changed:
            came = self._changed.wait_for(
                lambda: question.number in self._answers or self._state == "closed", _ANSWER_S
            )
            if question.number in self._answers:
                return self._answers.pop(question.number)
        if came:
            raise (self.trouble or DIED).error()
        raise DeviceError(
            f"the bench did not answer within {_ANSWER_S:g} s; look at the lamps",
            device=self.bench_id,
            code="bench-silent",
        )

    def _send(self, command: Command) -> None:
        with self._lock:
            if self._child is None or self._state in {"opening", "closed"}:
                raise self._not_ready()
            try:
                self._child.send(command)
            except OSError as error:
                raise DIED.error() from error

    def _not_ready(self) -> DarkflatError:
        if self.trouble is not None:
            return self.trouble.error()
        return DeviceError(
            f"the bench {self.bench_id!r} is {self._state}; try again soon",
            device=self.bench_id,
            code="bench-not-ready",
        )

    def _ended(self) -> None:
        with self._changed:
            running, self._running = self._running, ""
            if self.trouble is None and self._child is not None:
                self.trouble = DIED
            self._state = "closed"
            self._changed.notify_all()
        if running:
            self.listener(Ended(running, trouble=DIED))

    def _take(self, report: Report) -> None:
        with self._changed:
            match report:
                case Answer(number, look):
                    self._answers[number] = self.look = look
                case Opened(look):
                    self._state, self.look, self.trouble = "idle", look, None
                case Waiting(trouble) | Refused(trouble):
                    self.trouble = trouble
                case Ended():
                    self._state, self._running = "idle", ""
                case _:
                    pass
            self._changed.notify_all()
        if not isinstance(report, Answer):
            self.listener(report)
