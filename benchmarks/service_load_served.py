"""The service that is asked: a process with a simulated bench, one key, and a sweep that runs."""

import contextlib
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

import httpx2
import tomli_w
from prometheus_client.parser import text_string_to_metric_families

from service.settings import Settings
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.store import Store

COLUMNS, LINE_PERIOD_US = 6144, 307.2  # 20 MB/s of 8-bit codes
FRAME_LINES, LINES = 714, 27 * 714  # 5.9 s a block
BENCH: dict[str, Any] = {
    "id": f"load-{os.getpid()}",
    "camera": {"driver": "mock"},
    "light": {"driver": "mock"},
    "monitor": {"driver": "mock", "integration_s": 0.01},
    "shutter": {"driver": "mock"},
    "simulation": {"model": "agcam-nir", "lamps": 2},
}


@dataclass(frozen=True)
class Served:
    """Where the service answers, a key that opens it, and its process."""

    url: str
    key: str
    pid: int

    def processor_s(self) -> dict[str, float]:
        """Return the processor time of its two processes so far, by its own metrics."""
        told = self._ask("GET", "/metrics").text
        samples = {s.name: s.value for f in text_string_to_metric_families(told) for s in f.samples}
        return {
            "service": samples["process_cpu_seconds_total"],
            "bench": samples["darkflat_bench_process_cpu_seconds_total"],
        }

    def diagnose(self, digest: str) -> str:
        """Begin to diagnose a recording; return the job's id."""
        job: str = self._ask("POST", "/v1/diagnoses", json={"recording": digest}).json()["id"]
        return job

    def children(self) -> set[int]:
        """Return the processes that it has started and that are not over (Linux)."""
        told = (each.read_text() for each in Path(f"/proc/{self.pid}/task").glob("*/children"))
        return {int(child) for children in told for child in children.split()}

    def _ask(self, method: str, path: str, json: Any = None) -> httpx2.Response:
        headers = {"Authorization": f"Bearer {self.key}"}
        with httpx2.Client(base_url=self.url, headers=headers, trust_env=False) as http:
            return http.request(method, path, json=json).raise_for_status()


def plan(seconds: float) -> dict[str, Any]:
    """Return a sweep that takes a little longer than `seconds`."""
    blocks = int(seconds / (LINES * LINE_PERIOD_US * 1e-6)) + 2
    return {
        "name": "load",
        "sweep": {
            "type": "exposure", "exposures_us": [20.0 + n for n in range(blocks)], "level": 1,
        },
        "darks": "none",
        "lines": LINES,
        "frame_lines": FRAME_LINES,
        "camera": {
            "columns": COLUMNS, "line_period_us": LINE_PERIOD_US, "pixel_format": "Mono8",
        },
        "settle": {"tolerance_percent": 2.0, "stable_for_s": 0.1, "interval_s": 0.02},
    }  # fmt: skip


@contextlib.contextmanager
def serving(folder: Path) -> Iterator[Served]:
    """Start a service with a simulated bench."""
    (folder / "bench.toml").write_text(tomli_w.dumps(BENCH))
    with Store.open(Settings(home=folder / "home")) as store:
        _, key = store.keys.create("load", Scope.OPERATE, expires_at=None, by=Actor("load"))
    code = "from service.cli import main; main()"
    command = [sys.executable, "-c", code, "serve", "--port", "0", "--json", "-"]
    with subprocess.Popen(
        [*command, "--bench", str(folder / "bench.toml")],
        stdout=subprocess.PIPE, text=True, start_new_session=True,  # as an init system has it
        env={**os.environ, "DARKFLAT_HOME": str(folder / "home")},
    ) as process:  # fmt: skip
        try:
            assert process.stdout is not None
            told = "".join(takewhile(lambda line: line != "}\n", process.stdout))
            yield Served(json.loads(told + "}")["url"], key, process.pid)
        finally:
            process.terminate()
