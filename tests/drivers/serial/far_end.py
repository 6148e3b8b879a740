"""A device on a pseudo-terminal whose answers a test writes down."""

import os
import queue
import select
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path

Script = Callable[[bytes], list[tuple[float, bytes]]]


class FarEnd:
    """Answers each CR-ended command by a script: (seconds to wait, bytes to say) in turn.

    It answers one command after the other, as a device does, but hears each one at once: a script
    may wait for what comes next (`wait_for`). `WHO?` is answered `me`.
    """

    def __init__(self, path: Path, script: Script) -> None:
        self.path = path
        self.script = script
        self.heard: list[bytes] = []
        self.answers_who: Script = lambda _: [(0.0, b"me\r")]
        self.plug()

    def plug(self) -> None:
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.path.symlink_to(os.ttyname(self.slave))
        self._unplugged = threading.Event()
        self._to_answer: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._hears = threading.Condition()
        self._threads = [
            threading.Thread(target=each, daemon=True) for each in (self._hear, self._answer)
        ]
        for thread in self._threads:
            thread.start()

    def unplug(self) -> None:
        if not self._unplugged.is_set():
            self._unplugged.set()
            for thread in self._threads:
                thread.join()
            self.path.unlink()
            os.close(self.slave)
            os.close(self.master)

    def wait_for(self, command: bytes, times: int = 1) -> None:
        """Return once `command` has been heard so often."""
        with self._hears:
            assert self._hears.wait_for(lambda: self.heard.count(command) >= times, timeout=30)

    def _hear(self) -> None:
        pending = b""
        while not self._unplugged.is_set():
            if not select.select([self.master], [], [], 0.01)[0]:
                continue
            *commands, pending = (pending + os.read(self.master, 100)).split(b"\r")
            for command in commands:
                with self._hears:
                    self.heard.append(command)
                    self._hears.notify_all()
                self._to_answer.put(command)
        self._to_answer.put(None)

    def _answer(self) -> None:
        while (command := self._to_answer.get()) is not None:
            script = self.answers_who if command == b"WHO?" else self.script
            for wait_s, said in script(command):
                time.sleep(wait_s)
                os.write(self.master, said)
