"""`python -m benchmarks.service_load`: many clients ask while a sweep runs; how long answers take.

By default 200 clients poll the run at 1 Hz and 50 follow its events for 60 s, while the simulated
bench sweeps 6144 columns at 20 MB/s. Clients and service share this machine: what is printed is an
upper bound of what the service takes. The exit status is 1 where an answer was an error, an event
stream had a gap, the sweep lost a frame, or 99 % of the answers took 250 ms or longer.
"""

import argparse
import asyncio
import contextlib
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import tomli_w

from service.client import Client

COLUMNS, LINE_PERIOD_US = 6144, 307.2  # 20 MB/s of 8-bit codes
FRAME_LINES, LINES = 714, 27 * 714  # 5.9 s a block
MOST_P99_S = 0.25
BENCH: dict[str, Any] = {
    "id": f"load-{os.getpid()}",
    "camera": {"driver": "mock"},
    "light": {"driver": "mock"},
    "monitor": {"driver": "mock", "integration_s": 0.01},
    "shutter": {"driver": "mock"},
    "simulation": {"model": "agcam-nir", "lamps": 2},
}


@dataclass
class Seen:
    """What the clients saw.

    Attributes:
        took_s: Of each answer.
        errors: How often, by kind.
        streams: The numbers of the events of each stream.
    """

    took_s: list[float] = field(default_factory=list)
    errors: Counter[str] = field(default_factory=Counter)
    streams: list[list[int]] = field(default_factory=list)


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
def serving(folder: Path) -> Iterator[str]:
    """Start a service with a simulated bench and give its URL."""
    (folder / "bench.toml").write_text(tomli_w.dumps(BENCH))
    code = "from service.cli import main; main()"
    command = [sys.executable, "-c", code, "serve", "--port", "0", "--json", "-"]
    with subprocess.Popen(
        [*command, "--bench", str(folder / "bench.toml")],
        stdout=subprocess.PIPE, text=True,
        env={**os.environ, "DARKFLAT_HOME": str(folder / "home")},
    ) as process:  # fmt: skip
        try:
            assert process.stdout is not None
            told = "".join(takewhile(lambda line: line != "}\n", process.stdout))
            yield json.loads(told + "}")["url"]
        finally:
            process.terminate()


async def poll(http: httpx2.AsyncClient, place: str, until_s: float, seen: Seen) -> None:
    """Ask once a second, at a phase of its own."""
    await asyncio.sleep(random.random())
    while (began_s := time.monotonic()) < until_s:
        try:
            answer = await http.get(place)
            if answer.status_code != 200:
                seen.errors[str(answer.status_code)] += 1
        except httpx2.TransportError as error:
            seen.errors[type(error).__name__] += 1
        took_s = time.monotonic() - began_s
        seen.took_s.append(took_s)
        await asyncio.sleep(max(0.0, 1.0 - took_s))


async def follow(http: httpx2.AsyncClient, place: str, seen: Seen) -> None:
    """Read a run's events to their end."""
    numbers: list[int] = []
    seen.streams.append(numbers)
    try:
        async with http.stream("GET", f"{place}/events") as response:
            async for event in httpx2.EventSource(response):
                numbers.append(int(event.id))  # noqa: PERF401  (what came before it broke counts)
    except httpx2.TransportError as error:
        seen.errors[f"stream: {type(error).__name__}"] += 1


async def load(url: str, run_id: str, asked: argparse.Namespace) -> Seen:
    """Poll and follow for the time that is asked for, and to the end of the run."""
    seen, place = Seen(), f"/v1/runs/{run_id}"
    limits = httpx2.Limits(max_connections=None, max_keepalive_connections=None)
    until_s = time.monotonic() + asked.seconds
    async with httpx2.AsyncClient(
        base_url=url, limits=limits, timeout=30.0, trust_env=False
    ) as http:
        await asyncio.gather(
            *(poll(http, place, until_s, seen) for _ in range(asked.clients)),
            *(follow(http, place, seen) for _ in range(asked.streams)),
        )
    return seen


def main() -> int:
    """Print what was seen; return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.service_load", description=__doc__)
    parser.add_argument("--clients", type=int, default=200, help="that poll at 1 Hz")
    parser.add_argument("--streams", type=int, default=50, help="of events")
    parser.add_argument("--seconds", type=float, default=60.0)
    asked = parser.parse_args()
    with (
        tempfile.TemporaryDirectory(prefix="darkflat-load-") as name,
        serving(Path(name)) as url,
        Client(url, patience_s=120.0) as client,
    ):
        while client.bench.get().state != "idle":
            time.sleep(0.1)
        run = client.runs.start(plan(asked.seconds))
        while client.runs.get(run.id).blocks_done == 0:
            time.sleep(0.1)
        seen = asyncio.run(load(url, run.id, asked))
        run = client.runs.wait(run.id)
        events = sum(1 for _ in client.runs.follow(run.id))
    return report(seen, run.result or {}, events)


def report(seen: Seen, result: dict[str, Any], events: int) -> int:
    """Say how long answers took, and what went wrong."""
    p50, p99 = np.percentile(seen.took_s, [50, 99])
    gaps = sum(numbers != list(range(1, events + 1)) for numbers in seen.streams)
    rate = result["frames"] * FRAME_LINES * COLUMNS / 1e6 / result["seconds"]
    print(f"{len(seen.took_s)} answers: p50 {p50 * 1e3:.1f} ms, p99 {p99 * 1e3:.1f} ms,", end=" ")
    print(f"longest {max(seen.took_s) * 1e3:.0f} ms; errors: {dict(seen.errors) or 'none'}")
    print(f"{len(seen.streams)} streams of {events} events, {gaps} with a gap")
    print(f"sweep: {result['frames']} frames, {result['lost_frames']} lost, {rate:.1f} MB/s")
    good = not seen.errors and not gaps and result["lost_frames"] == 0 and p99 < MOST_P99_S
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
