"""`darkflat serve` in a process of its own, that can be killed and started again."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import takewhile
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import tomli_w

from service.bench.settings import BenchSettings
from service.client import Client

ROOT = Path(__file__).parents[2]
READY_S = 120.0


class Served:
    """A service on one port, before and after its deaths.

    Attributes:
        home: Its DARKFLAT_HOME.
        url: Where it answers.
        pid: Of the process that answers now.
    """

    def __init__(self, folder: Path, bench: BenchSettings) -> None:
        self.home = folder / "home"
        self.url = ""
        self._bench = folder / "bench.toml"
        self._bench.write_text(tomli_w.dumps(bench.model_dump(mode="json", exclude_none=True)))
        self._log = folder / "service.log"
        self._process: subprocess.Popen[str] | None = None

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    def start(self) -> None:
        """Start it, at the port that it had before, and return once it listens."""
        port = urlsplit(self.url).port or 0
        code = "from service.cli import main; main()"
        command = [sys.executable, "-c", code, "serve", "--bench", str(self._bench)]
        with self._log.open("a") as log:
            self._process = subprocess.Popen(
                [*command, "--port", str(port), "--json", "-"],
                stdout=subprocess.PIPE, stderr=log, text=True, cwd=ROOT,
                env={**os.environ, "DARKFLAT_HOME": str(self.home)},
            )  # fmt: skip
        assert self._process.stdout is not None
        lines = takewhile(lambda line: line != "}\n", self._process.stdout)
        told = "".join(lines)
        assert told, self.log()
        self.url = json.loads(told + "}")["url"]

    def kill(self) -> None:
        """kill -9 of the server alone."""
        assert self._process is not None
        self._process.kill()
        self._reap()

    def stop(self) -> None:
        """Let it end as it should; kill it where it does not."""
        if self._process is None or self._process.poll() is not None:
            return
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(60)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._reap()

    def log(self) -> str:
        return self._log.read_text()

    def _reap(self) -> None:
        assert self._process is not None
        self._process.wait()
        assert self._process.stdout is not None
        self._process.stdout.close()

    def client(self, **options: Any) -> Client:
        """Return a client that waits as long as a busy machine takes to start a service."""
        return Client(self.url, **{"patience_s": READY_S, **options})


@contextmanager
def served(folder: Path, bench: BenchSettings) -> Iterator[Served]:
    """Give a service whose bench is open."""
    service = Served(folder, bench)
    try:
        service.start()
        with service.client() as client:
            until_idle(client)
        yield service
    finally:
        service.stop()


def until_idle(client: Client, within_s: float = READY_S) -> None:
    """Return once the bench is open and free."""
    deadline_s = time.monotonic() + within_s
    while (bench := client.bench.get()).state != "idle":
        assert time.monotonic() < deadline_s, bench
        time.sleep(0.05)


def children(pid: int) -> list[int]:
    """Return the processes that `pid` has started, in whichever of its threads."""
    of_threads = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(each) for of_thread in of_threads for each in of_thread.read_text().split()]
