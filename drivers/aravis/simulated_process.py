"""Starts and stops a simulated GigE Vision camera in a process of its own."""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO, Self

from calib.closing import Closing
from drivers.aravis.line_reader import LineReader
from drivers.aravis.simulated import address_lock
from drivers.errors import DeviceError

_OBEYS_WITHIN_S = 30.0


class SimulatedCameraProcess(Closing):
    """A context manager: the camera answers at `address` inside the block, and is gone after it.

    It dies with this process, too: its standard input is a pipe that only this process holds. But
    not by Ctrl-C at the terminal, which goes to every process of the foreground's group: it has a
    group of its own, and stays while its client cleans up.

    Faults come at once or after a number of frames. At once is when nobody knows: a busy machine
    sends any number of frames before it hears of the fault.

    Args:
        model: A model file as a Path; as text, what `Model.named` understands.
        world: The file of the simulated world (`drivers.mock.world`).
        serial: The serial number that the camera tells; the model's where None.
        interface: The address it answers at; it must be one of this machine's own.
        seed: Of the noise of its first start, which no later one repeats; None: the system's.
        dialect: How it names its features: `sfnc2`, or `sfnc1` as older cameras do.
        wait_s: How long to wait for an address that another simulated camera occupies.
        ready_within_s: Deadline for its start, the compilation of the kernels included.
    """

    def __init__(
        self,
        model: Path | str,
        world: Path,
        *,
        serial: str | None = None,
        interface: str = "127.0.0.1",
        seed: int | None = None,
        dialect: str = "sfnc2",
        wait_s: float = 0.0,
        ready_within_s: float = 120.0,
    ) -> None:
        self.address = interface
        self._command = [
            *(sys.executable, "-m", "drivers.aravis.simulated"),
            *("--model", str(model.absolute() if isinstance(model, Path) else model)),
            *("--world", str(world)),
            *(() if serial is None else ("--serial", serial)),
            *("--interface", interface),
            *("--dialect", dialect),
            *("--wait", str(wait_s)),
        ]
        self._seeded: tuple[str, ...] = () if seed is None else ("--seed", str(seed))
        self._deadline_s = ready_within_s + wait_s
        self._lock: int | None = None
        self._process: subprocess.Popen[str] | None = None
        self._said: LineReader | None = None
        self._errors: IO[str] | None = None

    def start(self) -> Self:
        """Start the camera; return once it answers.

        Raises:
            DeviceError: Code `simulated-camera-failed`, with what it said, when it does not start.
        """
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  lives as long as the process
        if self._lock is None:
            self._lock = address_lock.opened(self.address)
        seeded, self._seeded = self._seeded, ()
        self._process = subprocess.Popen(  # noqa: S603  our own module
            [*self._command, *seeded, "--lock", str(self._lock)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            bufsize=1,
            process_group=0,
            pass_fds=(self._lock,),
        )
        if self._process.stdout is not None:
            self._said = LineReader(self._process.stdout)
        if self._answer(self._deadline_s) != "ready":
            said = self.said()
            self.kill()
            self._give_address_back()
            raise self._error(f"did not start: {said or 'it said nothing'}")
        return self

    @property
    def is_running(self) -> bool:
        """Whether it has been started and has not died."""
        return self._process is not None and self._process.poll() is None

    @property
    def pid(self) -> int | None:
        """Its process id, None where it is not started."""
        return None if self._process is None else self._process.pid

    def said(self) -> str:
        """Return what it has written to standard error so far."""
        if self._errors is None:
            return ""
        self._errors.seek(0)
        return self._errors.read().strip()

    def lose_packets(self, ratio: float, *, after_frames: int = 0) -> None:
        """Fault: lose this share of the packets (after so many more frames); 0 mends it."""
        self._tell(f"lose {ratio} {after_frames}")

    def stall(self, *, after_frames: int = 0) -> None:
        """Fault: answer, but send no frames any more (after so many more), until `resume`."""
        self._tell(f"stall {after_frames}")

    def die(self, *, after_frames: int) -> None:
        """Fault: die once so many more frames are sent; `kill` clears away what is left."""
        self._tell(f"die {after_frames}")

    def resume(self) -> None:
        """Send frames again."""
        self._tell("resume")

    def draw_afresh(self) -> None:
        """Draw noise from now on that no seed repeats."""
        self._tell("afresh")

    def hang(self) -> None:
        """Fault: stop answering at all, without dying, until `wake`."""
        self._signal(signal.SIGSTOP)

    def wake(self) -> None:
        """Go on after `hang`."""
        self._signal(signal.SIGCONT)

    def kill(self) -> None:
        """Fault: die at once, as a camera does that is unplugged; nobody else gets its address."""
        if self._process is not None:
            self._process.kill()
            self._release()

    def close(self) -> None:
        """End the camera in an orderly way; safe to call twice."""
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()
            self.wake()
            try:
                self._process.wait(5.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
            self._release()
        self._give_address_back()

    def __enter__(self) -> Self:
        return self.start()

    def _tell(self, command: str) -> None:
        if self._process is None or self._process.stdin is None:
            raise self._error("is not running")
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()
        if self._answer(_OBEYS_WITHIN_S) != "ok":
            raise self._error(f"did not obey `{command}`: {self.said()}")

    def _answer(self, timeout_s: float) -> str:
        return "" if self._said is None else self._said.next(timeout_s)

    def _signal(self, number: signal.Signals) -> None:
        if self._process is None:
            raise self._error("is not running")
        self._process.send_signal(number)

    def _release(self) -> None:
        if self._process is None:
            return
        self._process.wait()
        if self._said is not None:
            self._said.join()
        for stream in (self._process.stdin, self._process.stdout, self._errors):
            if stream is not None:
                stream.close()
        self._process = None

    def _give_address_back(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _error(self, what: str) -> DeviceError:
        device = f"simulated camera at {self.address}"
        return DeviceError(f"{device} {what}", device=device, code="simulated-camera-failed")
