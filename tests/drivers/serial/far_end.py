"""A device on a pseudo-terminal whose answers a test writes down."""

import os
import select
import threading
import time
import tty
from collections.abc import Callable
from pathlib import Path

Script = Callable[[bytes], list[tuple[float, bytes]]]


class FarEnd:
    """Answers each CR-ended command by a script: (seconds to wait, bytes to say) in turn.

    It answers one command after the other, as a device does. `WHO?` is answered `me`.
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
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def unplug(self) -> None:
        if not self._unplugged.is_set():
            self._unplugged.set()
            self._thread.join()
            self.path.unlink()
            os.close(self.slave)
            os.close(self.master)

    def _serve(self) -> None:
        pending = b""
        while not self._unplugged.is_set():
            if not select.select([self.master], [], [], 0.01)[0]:
                continue
            *commands, pending = (pending + os.read(self.master, 100)).split(b"\r")
            for command in commands:
                self.heard.append(command)
                script = self.answers_who if command == b"WHO?" else self.script
                for wait_s, said in script(command):
                    time.sleep(wait_s)
                    os.write(self.master, said)
