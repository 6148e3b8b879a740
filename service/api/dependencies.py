"""What routes need: the store, the settings, who does the work."""

from dataclasses import dataclass, field
from typing import Annotated, cast

from fastapi import Depends, Request

from service.api.failures import Failures
from service.api.jobs.runner import JobRunner
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
    failures: Failures = field(default_factory=Failures)
    """Of keys that were tried."""


def parts(request: Request) -> Parts:
    """Return what the app was started with."""
    return cast("Parts", request.app.state.parts)


def _store(request: Request) -> Store:
    return parts(request).store


def _settings(request: Request) -> Settings:
    return parts(request).settings


def _runner(request: Request) -> JobRunner:
    return parts(request).runner


def _keeper(request: Request) -> RunKeeper:
    keeper = parts(request).keeper
    if keeper is None:
        msg = "this service has no bench; start it with --bench bench.toml"
        raise StoreError(msg, code="no-bench")
    return keeper


def _commands(request: Request) -> RunCommands:
    return RunCommands(_store(request), _keeper(request))


StoreDep = Annotated[Store, Depends(_store)]
SettingsDep = Annotated[Settings, Depends(_settings)]
RunnerDep = Annotated[JobRunner, Depends(_runner)]
KeeperDep = Annotated[RunKeeper, Depends(_keeper)]
CommandsDep = Annotated[RunCommands, Depends(_commands)]
