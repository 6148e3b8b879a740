"""What the service keeps and does, read when somebody asks."""

from collections.abc import Callable, Iterator, Mapping
from typing import get_args

from prometheus_client import CollectorRegistry, Metric, ProcessCollector
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from service.owner.owner import OwnerState
from service.runs.keeper import RunKeeper
from service.store.store import Store

State = tuple[Store, RunKeeper | None]


def watch(registry: CollectorRegistry, state: Callable[[], State | None]) -> None:
    """Have `registry` tell of the service.

    Args:
        registry: Of one app.
        state: Gives what the app has opened; None while it is closed.
    """

    def bench_pid() -> str:
        opened = state()
        keeper = None if opened is None else opened[1]
        return str(keeper.owner.pid) if keeper is not None else "none"

    registry.register(_Service(state))
    ProcessCollector(registry=registry)
    ProcessCollector(namespace="darkflat_bench", pid=bench_pid, registry=registry)


class _Service(Collector):
    def __init__(self, state: Callable[[], State | None]) -> None:
        self._state = state

    def collect(self) -> Iterator[Metric]:
        """Yield what is asked for; nothing while the app is closed."""
        opened = self._state()
        if opened is None:
            return
        store, keeper = opened
        yield _by_state("darkflat_runs", "Runs on record.", store.counts.runs())
        yield _by_state("darkflat_jobs", "Jobs on record.", store.counts.jobs())
        if keeper is not None:
            now = keeper.owner.state
            states = {each: int(each == now) for each in get_args(OwnerState)}
            yield _by_state("darkflat_bench_state", "1 for what the bench does.", states)
            reachable = GaugeMetricFamily("darkflat_bench_reachable", "1 where it can be used.")
            reachable.add_metric((), int(now in {"idle", "busy"}))
            yield reachable
            yield _total("darkflat_frames", "Frames recorded since the start.", keeper.frames.kept)
            yield _total("darkflat_lost_frames", "Lost and taken again.", keeper.frames.lost)


def _by_state(name: str, what: str, counts: Mapping[str, int]) -> Metric:
    gauge = GaugeMetricFamily(name, what, labels=("state",))
    for state, count in counts.items():
        gauge.add_metric((state,), count)
    return gauge


def _total(name: str, what: str, count: int) -> Metric:
    counter = CounterMetricFamily(name, what)
    counter.add_metric((), count)
    return counter
