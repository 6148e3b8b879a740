"""One emulated device on a pseudo-terminal, byte by byte at the line's speed."""

import os
import select
import termios
import time
import tty
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from threading import Condition, Thread
from typing import Protocol

from drivers.mock.emulators.line_faults import LineFaults

_BITS_PER_CHARACTER = 10  # start, 8 data, stop
_IDLE_S = 0.03


@dataclass(frozen=True)
class Reply:
    """What a device says, and how long it measures before."""

    data: bytes
    after_s: float = 0.0


class EmulatedDevice(Protocol):
    """The far end of a line."""

    def receive(self, data: bytes) -> list[Reply]:
        """Take bytes as they come; return what is said to them."""
        ...

    def tick(self) -> None:
        """Let time pass: called often."""
        ...


class PtyLine:
    """Serves `device` in a thread of its own, which alone plugs the line in and out.

    `path` is a link to the present pseudo-terminal, and stays the same when the device vanishes
    and returns, as the links of /dev/serial/by-id do. The slave side is held open here: otherwise
    the master would fail whenever the client closes.
    """

    def __init__(
        self, path: Path, device: EmulatedDevice, *, baudrate: int = 9600, turnaround_s: float = 0.0
    ) -> None:
        """Serve `device` at `path`; it takes `turnaround_s` to answer anything."""
        self.path = path
        self.device = device
        self.faults = LineFaults()
        self._turnaround_s = turnaround_s
        self._character_s = _BITS_PER_CHARACTER / baudrate
        self._ends: tuple[int, int] | None = None
        self._heard: deque[tuple[float, bytes]] = deque()  # when it has arrived whole
        self._said: deque[tuple[float, bytes]] = deque()  # when its last character may leave
        self._speaking_until = 0.0
        self._order = Condition()  # guards the two below, and tells when they agree
        self._is_wanted = True
        self._is_stopping = False
        self._plug_in()
        self._thread = Thread(target=self._serve, name=f"emulator {path.name}", daemon=True)
        self._thread.start()

    def vanish(self) -> None:
        """Pull the plug of the line; the device keeps its power, and goes on with what it does."""
        self._have(plugged_in=False)

    def come_back(self) -> None:
        """Plug the line in again, on another pseudo-terminal behind the same path."""
        self._have(plugged_in=True)

    def stop(self) -> None:
        """Have the thread end soon; `close` waits for it."""
        with self._order:
            self._is_stopping = True
            self._order.notify_all()

    def close(self) -> None:
        """Stop serving; safe to call twice."""
        self.stop()
        self._thread.join()
        self._unplug()

    def _have(self, *, plugged_in: bool) -> None:
        """Return once it is so, or the thread has ended."""
        with self._order:
            self._is_wanted = plugged_in
            self._order.notify_all()
            self._order.wait_for(
                lambda: self._is_stopping or (self._ends is not None) == plugged_in
            )

    def _serve(self) -> None:
        try:
            while self._obey():
                if self._ends is None:
                    self.device.tick()
                else:
                    self._serve_once(self._ends[0])
        finally:
            self.stop()  # nobody waits for a thread that a defect has ended

    def _obey(self) -> bool:
        """Plug in or out as is wanted, rest where it is out; return False where it is to end."""
        with self._order:
            if self._is_wanted != (self._ends is not None):
                if self._is_wanted:
                    self._plug_in()
                else:
                    self._unplug()
                self._order.notify_all()
            if self._ends is None and not self._is_stopping:
                self._order.wait(_IDLE_S)
            return not self._is_stopping

    def _serve_once(self, master: int) -> None:
        now = time.monotonic()
        while self._heard and self._heard[0][0] <= now:
            self._answer(self._heard.popleft()[1])
        while self._said and self._said[0][0] <= now:
            self._send(self._said.popleft()[1])
        self.device.tick()
        due = [queue[0][0] for queue in (self._heard, self._said) if queue]
        wait_s = min([_IDLE_S, *(max(moment - time.monotonic(), 0.0) for moment in due)])
        if select.select([master], [], [], wait_s)[0]:
            self._hear(master)

    def _hear(self, master: int) -> None:
        data = os.read(master, 4096)
        last = self._heard[-1][0] if self._heard else time.monotonic()
        self._heard.append((last + len(data) * self._character_s, data))

    def _answer(self, data: bytes) -> None:
        if self.faults.deaf:
            return
        for reply in self.device.receive(data):
            spoilt, late_s = self.faults.spoil(reply.data)
            ready = time.monotonic() + self._turnaround_s + reply.after_s + late_s
            starts = max(ready, self._speaking_until)
            for i in range(len(spoilt)):
                leaves = starts + (i + 1) * self._character_s
                self._said.append((leaves, spoilt[i : i + 1]))
                self._speaking_until = leaves

    def _send(self, data: bytes) -> None:
        if self._ends is not None:
            try:
                os.write(self._ends[0], data)
            except BlockingIOError:
                termios.tcflush(self._ends[1], termios.TCIFLUSH)  # nobody reads: it is lost

    def _plug_in(self) -> None:
        master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        part = self.path.with_name(f".{self.path.name}.part")
        part.unlink(missing_ok=True)
        part.symlink_to(os.ttyname(slave))
        part.replace(self.path)
        self._ends = (master, slave)

    def _unplug(self) -> None:
        self._heard.clear()
        self._said.clear()
        self._speaking_until = 0.0
        if self._ends is not None:
            ends, self._ends = self._ends, None
            self.path.unlink(missing_ok=True)
            for end in ends:
                os.close(end)
