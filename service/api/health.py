"""`/healthz` and `/readyz`: for whoever watches the service."""

from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel

from service.api.dependencies import RunnerDep, StoreDep
from service.api.openapi import problems

router = APIRouter(tags=["health"])


class Alive(BaseModel):
    """The process answers."""

    status: Literal["alive"] = "alive"


class Ready(BaseModel):
    """It can do its work."""

    status: Literal["ready"] = "ready"
    store: Literal["writable"] = "writable"


@router.get("/healthz", responses=problems(keyless=True))
def healthz(runner: RunnerDep) -> Alive:
    """Say that the process is alive and does jobs; a problem where only a restart helps."""
    runner.check_alive()
    return Alive()


@router.get("/readyz", responses=problems(keyless=True))
def readyz(store: StoreDep, runner: RunnerDep) -> Ready:
    """Say that jobs are done and the store can be written; a problem otherwise."""
    runner.check_alive()
    store.check_writable()
    return Ready()
