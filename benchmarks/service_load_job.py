"""`python -m benchmarks.service_load_job`: how long answers take while a diagnosis calculates.

A recording of 6144 columns × 714 lines × 31 blocks is uploaded and diagnosed; one client asks how
far the job is, 50 times a second. Then the diagnosis is begun once more, and cancelled. The exit
status is 1 where an answer was an error, 99 % of them took 50 ms or longer, or the job's process
outlived its cancellation by a second.
"""

import argparse
import asyncio
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.diagnosis import MANY, record
from benchmarks.service_load_clients import Line, Seen
from benchmarks.service_load_served import Served, serving
from service.api.answers.job import JobAnswer
from service.client import Client

MOST_P99_S, MOST_ALIVE_S = 0.05, 1.0
EVERY_S = 0.02
FINAL = frozenset({"succeeded", "failed", "cancelled", "interrupted"})


async def ask_until_done(served: Served, client: Client, job_id: str) -> Seen:
    """Ask for the job every 20 ms; look four times a second whether it is done."""
    line, seen = await Line.open(served.url, served.key), Seen()

    async def until_done() -> None:
        while (await asyncio.to_thread(client.jobs.get, job_id)).state not in FINAL:
            await asyncio.sleep(0.25)

    done = asyncio.create_task(until_done())
    while not done.done():
        began_s = time.monotonic()
        status = await line.get(f"/v1/jobs/{job_id}")
        seen.took_s.append(time.monotonic() - began_s)
        if status != 200:
            seen.errors[str(status)] += 1
        await asyncio.sleep(max(0.0, began_s + EVERY_S - time.monotonic()))
    await done
    line.close()
    return seen


def cancelled_within_s(served: Served, client: Client, digest: str) -> tuple[float, float]:
    """Begin a diagnosis, and cancel it; return when that was answered and its process gone."""
    others = served.children()
    job_id = served.diagnose(digest)
    while not (begun := served.children() - others):
        time.sleep(0.05)
    time.sleep(3.0)  # well into its work
    began_s = time.monotonic()
    client.jobs.cancel(job_id)
    answered_s = time.monotonic() - began_s
    while begun & served.children() and time.monotonic() - began_s < 60.0:
        time.sleep(0.001)
    return answered_s, time.monotonic() - began_s


def main() -> int:
    """Print what was seen; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.service_load_job", description=__doc__
    )
    parser.add_argument("--columns", type=int, default=6144)
    parser.add_argument("--lines", type=int, default=714)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="darkflat-load-") as name:
        recording = Path(name) / "recording.h5"
        record(recording, MANY, asked.columns, asked.lines)
        with (
            serving(Path(name)) as served,
            Client(served.url, key=served.key, patience_s=120.0) as client,
        ):
            digest = client.recordings.upload(recording).digest
            began_s, job_id = time.monotonic(), served.diagnose(digest)
            seen = asyncio.run(ask_until_done(served, client, job_id))
            took_s, job = time.monotonic() - began_s, client.jobs.get(job_id)
            return report(seen, job, took_s, *cancelled_within_s(served, client, digest))


def report(seen: Seen, job: JobAnswer, seconds: float, answered_s: float, gone_s: float) -> int:
    """Say how long answers took, and how the job ended."""
    p50, p99 = np.percentile(seen.took_s, [50, 99]) * 1e3
    print(f"the diagnosis {job.state} after {seconds:.1f} s")
    print(f"{len(seen.took_s)} answers meanwhile: p50 {p50:.1f} ms, p99 {p99:.1f} ms,", end=" ")
    print(f"longest {max(seen.took_s) * 1e3:.0f} ms; errors: {dict(seen.errors) or 'none'}")
    print(f"cancelled: answered after {answered_s * 1e3:.0f} ms,", end=" ")
    print(f"its process gone after {gone_s * 1e3:.0f} ms")
    good = job.state == "succeeded" and not seen.errors and gone_s < MOST_ALIVE_S
    return 0 if good and p99 < MOST_P99_S * 1e3 else 1


if __name__ == "__main__":
    sys.exit(main())
