"""One server, run after run: memory, handles and threads stay flat, in both of its processes."""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from service.client import Client
from tests.service.client.footprint import Footprint
from tests.service.sequencer.benches import in_process, short_plan
from tests.service.served import Served, children, served

RUNS, WARMING_UP = 200, 50
"""Pools of threads and of connections to the store fill, and what is imported late is imported."""
BYTES_PER_RUN = (1 << 30) / (200 * 365)
"""14.7 kB: 200 runs a day may take 1 GiB in a year, of a machine that is restarted more often."""


def footprints(service: Served, client: Client, bench_pid: int) -> tuple[Footprint, Footprint]:
    """Take a run, followed to its end, and look at the service and at the bench's process."""
    run = client.runs.start(short_plan().model_dump(mode="json"))
    for _ in client.runs.follow(run.id):
        pass
    assert client.runs.get(run.id).state == "succeeded"
    return Footprint.of(service.pid), Footprint.of(bench_pid)


def slope(values: Sequence[int]) -> tuple[float, float]:
    """Return the slope of a line through `values`, per step, and its standard error.

    That of independent deviations from the line; where they hang together in runs of k, it is
    sqrt(k) times as large (their lag-1 correlation r gives k = (1 + r) / (1 - r)).
    """
    y = np.asarray(values, np.float64)
    x = np.arange(y.size) - (y.size - 1) / 2
    per_step = float(x @ y / (x @ x))
    left = y - y.mean() - per_step * x
    variance = float(left @ left) / (y.size - 2)
    if variance == 0.0:
        return per_step, 0.0
    r = min(max(float(left[1:] @ left[:-1] / (left @ left)), 0.0), 0.95)
    return per_step, float(np.sqrt(variance / (x @ x) * (1 + r) / (1 - r)))


def assert_flat(name: str, seen: Sequence[Footprint]) -> None:
    late = seen[WARMING_UP:]
    per_run, std = slope([each.own_bytes for each in late])
    half = len(late) // 2
    peaks = [
        [max(getattr(each, what) for each in part) for part in (late[:half], late[half:])]
        for what in ("handles", "threads")
    ]
    print(  # noqa: T201  shown by pytest -rP
        f"{name}: {per_run:.0f} ± {std:.0f} bytes a run, {late[-1].own_bytes / 1e6:.1f} MB at the"
        f" end; at most {peaks[0]} handles and {peaks[1]} threads, each in half of the runs"
    )
    assert per_run + 2 * std < BYTES_PER_RUN
    for first, second in peaks:
        assert second <= first


@pytest.mark.soak
def test_two_hundred_runs_leave_memory_handles_and_threads_flat(tmp_path: Path) -> None:
    with (
        served(tmp_path, in_process(f"flat-{os.getpid()}")) as service,
        service.client() as client,
    ):
        bench_pid = max(children(service.pid), key=lambda pid: Footprint.of(pid).own_bytes)
        seen = [footprints(service, client, bench_pid) for _ in range(RUNS)]
    of_service, of_bench = zip(*seen, strict=True)
    assert_flat("service", of_service)
    assert_flat("bench", of_bench)
