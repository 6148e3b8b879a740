"""`python -m benchmarks.service_load`: many clients ask while a sweep runs; how long answers take.

By default 200 clients poll the run at 1 Hz and 50 follow its events for 60 s, while the simulated
bench sweeps 6144 columns at 20 MB/s. Clients, service and bench share this machine: what is printed
is an upper bound of what the service takes. The exit status is 1 where an answer was an error, an
event stream had a gap, the sweep lost a frame, or 99 % of the answers took 250 ms or longer.
"""

import argparse
import asyncio
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.service_load_clients import Seen, follow, poll
from benchmarks.service_load_served import COLUMNS, FRAME_LINES, Served, plan, serving
from service.client import Client

MOST_P99_S = 0.25


@dataclass(frozen=True)
class Cost:
    """Processor time by process, over so many seconds while clients asked."""

    seconds: float
    processor_s: dict[str, float]

    def __str__(self) -> str:
        shares = (f"{name} {s / self.seconds:.0%}" for name, s in self.processor_s.items())
        return ", ".join(shares)


async def load(served: Served, run_id: str, asked: argparse.Namespace) -> tuple[Seen, Cost]:
    """Poll for the time that is asked for, and follow to the end of the run."""
    seen, place = Seen(), f"/v1/runs/{run_id}"
    began, began_s = _processor_s(served), time.monotonic()
    followers = asyncio.gather(
        *(follow(served.url, served.key, f"{place}/events", seen) for _ in range(asked.streams))
    )
    until_s = began_s + asked.seconds
    await asyncio.gather(
        *(poll(served.url, served.key, place, until_s, seen) for _ in range(asked.clients))
    )
    took_s, ended = time.monotonic() - began_s, _processor_s(served)
    await followers
    return seen, Cost(took_s, {name: ended[name] - began[name] for name in ended})


def _processor_s(served: Served) -> dict[str, float]:
    return {**served.processor_s(), "clients": time.process_time()}


def main() -> int:
    """Print what was seen; return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.service_load", description=__doc__)
    parser.add_argument("--clients", type=int, default=200, help="that poll at 1 Hz")
    parser.add_argument("--streams", type=int, default=50, help="of events")
    parser.add_argument("--seconds", type=float, default=60.0)
    asked = parser.parse_args()
    with (
        tempfile.TemporaryDirectory(prefix="darkflat-load-") as name,
        serving(Path(name)) as served,
        Client(served.url, key=served.key, patience_s=120.0) as client,
    ):
        while client.bench.get().state != "idle":
            time.sleep(0.1)
        run = client.runs.start(plan(asked.seconds))
        while client.runs.get(run.id).blocks_done == 0:
            time.sleep(0.1)
        seen, cost = asyncio.run(load(served, run.id, asked))
        run = client.runs.wait(run.id)
        events = sum(1 for _ in client.runs.follow(run.id))
    return report(seen, cost, run.result or {}, events)


def report(seen: Seen, cost: Cost, result: dict[str, Any], events: int) -> int:
    """Say how long answers took, and what went wrong."""
    p50, p99 = np.percentile(seen.took_s, [50, 99])
    gaps = sum(numbers != list(range(1, events + 1)) for numbers in seen.streams)
    rate = result["frames"] * FRAME_LINES * COLUMNS / 1e6 / result["seconds"]
    print(f"{len(seen.took_s)} answers: p50 {p50 * 1e3:.1f} ms, p99 {p99 * 1e3:.1f} ms,", end=" ")
    print(f"longest {max(seen.took_s) * 1e3:.0f} ms; errors: {dict(seen.errors) or 'none'}")
    print(f"{len(seen.streams)} streams of {events} events, {gaps} with a gap")
    print(f"sweep: {result['frames']} frames, {result['lost_frames']} lost, {rate:.1f} MB/s")
    print(f"processor time, of one core: {cost}")
    good = not seen.errors and not gaps and result["lost_frames"] == 0 and p99 < MOST_P99_S
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
