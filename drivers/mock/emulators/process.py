"""The emulators in a process of their own, started and stopped from here."""

import json
import select
import subprocess
import sys
from pathlib import Path

from calib.closing import Closing

_START_S = 30.0
_STOP_S = 5.0


class EmulatorProcess(Closing):
    """Runs `python -m drivers.mock.emulators` while the context lasts.

    In a process group of its own: Ctrl-C at a terminal goes to every process of the foreground's,
    and lamps must outlive it, or whoever lit them could not switch them off.

    Attributes:
        ports: The paths to open: `lamps`, `led`, `monitor`, `shutter`; None where there is none.
        pid: The process.
    """

    def __init__(
        self, world: Path, *, lamps: int = 6, led: bool = False, options: tuple[str, ...] = ()
    ) -> None:
        """Start it and wait for its ports; `options` are passed on to the command line."""
        command = [sys.executable, "-m", "drivers.mock.emulators", "--control"]
        command += ["--world", str(world), "--lamps", str(lamps), *(["--led"] if led else [])]
        self._process = subprocess.Popen(  # noqa: S603 (our own module)
            [*command, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            process_group=0,
        )
        self.pid = self._process.pid
        try:
            self.ports: dict[str, str | None] = self._answer()
        except BaseException:
            self.close()
            raise

    def inject(self, fault: str) -> None:
        """Inject `fault`, in the words of `fault_commands.LANGUAGE`."""
        stdin = self._process.stdin
        if stdin is None:
            raise RuntimeError("the emulators were started without a control line")
        stdin.write(fault + "\n")
        stdin.flush()
        if "error" in (answer := self._answer()):
            raise ValueError(answer["error"])

    def close(self) -> None:
        """Stop it; safe to call twice."""
        if self._process.poll() is None:
            self._process.terminate()
        try:
            self._process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()

    def _answer(self) -> dict[str, str | None]:
        stdout = self._process.stdout
        if stdout is None or not select.select([stdout], [], [], _START_S)[0]:
            raise TimeoutError(f"the emulators (process {self.pid}) do not answer")
        line = stdout.readline()
        if not line:
            raise RuntimeError(f"the emulators (process {self.pid}) died; see standard error")
        answer: dict[str, str | None] = json.loads(line)
        return answer
