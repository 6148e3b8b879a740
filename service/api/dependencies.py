"""What routes need: the store, the settings, who does the work."""

from dataclasses import dataclass
from typing import Annotated, cast

from fastapi import Depends, Request

from service.api.jobs.runner import JobRunner
from service.settings import Settings
from service.store.store import Store


@dataclass(frozen=True)
class Parts:
    """What the app's lifespan opens and closes."""

    settings: Settings
    store: Store
    runner: JobRunner


def parts(request: Request) -> Parts:
    """Return what the app was started with."""
    return cast("Parts", request.app.state.parts)


def _store(request: Request) -> Store:
    return parts(request).store


def _settings(request: Request) -> Settings:
    return parts(request).settings


def _runner(request: Request) -> JobRunner:
    return parts(request).runner


StoreDep = Annotated[Store, Depends(_store)]
SettingsDep = Annotated[Settings, Depends(_settings)]
RunnerDep = Annotated[JobRunner, Depends(_runner)]
