"""What routes need: the store, the settings, who does the work.

All of it is there already, so these are coroutines: what is no coroutine waits for a thread.
"""

from dataclasses import dataclass, field
from typing import Annotated, cast

from fastapi import Depends, Request

from service.api.event_stream import EventStreams
from service.api.failures import Failures
from service.api.jobs.runner import JobRunner
from service.api.key_ring import KeyRing
from service.runs.commands import RunCommands
from service.runs.keeper import RunKeeper
from service.settings import Settings
from service.store.errors import StoreError
from service.store.store import Store


@dataclass(frozen=True)
class Parts:
    """What the app's lifespan opens and closes."""

    settings: Settings
    store: Store
    runner: JobRunner
    keeper: RunKeeper | None
    """None where the service has no bench."""
    streams: EventStreams | None
    """Of what its runs say; None likewise."""
    keys: KeyRing
    failures: Failures = field(default_factory=Failures)
    """Of keys that were tried."""


async def parts(request: Request) -> Parts:
    """Return what the app was started with."""
    return cast("Parts", request.app.state.parts)


PartsDep = Annotated[Parts, Depends(parts)]


async def _store(known: PartsDep) -> Store:
    return known.store


async def _settings(known: PartsDep) -> Settings:
    return known.settings


async def _runner(known: PartsDep) -> JobRunner:
    return known.runner


async def _keeper(known: PartsDep) -> RunKeeper:
    if known.keeper is None:
        raise _no_bench()
    return known.keeper


async def _streams(known: PartsDep) -> EventStreams:
    if known.streams is None:
        raise _no_bench()
    return known.streams


def _no_bench() -> StoreError:
    msg = "this service has no bench; start it with --bench bench.toml"
    return StoreError(msg, code="no-bench")


async def _commands(known: PartsDep, keeper: Annotated[RunKeeper, Depends(_keeper)]) -> RunCommands:
    return RunCommands(known.store, keeper)


StoreDep = Annotated[Store, Depends(_store)]
SettingsDep = Annotated[Settings, Depends(_settings)]
RunnerDep = Annotated[JobRunner, Depends(_runner)]
KeeperDep = Annotated[RunKeeper, Depends(_keeper)]
StreamsDep = Annotated[EventStreams, Depends(_streams)]
CommandsDep = Annotated[RunCommands, Depends(_commands)]
