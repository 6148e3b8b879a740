"""`/healthz` and `/readyz`: for whoever watches the service."""

from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel

from service.api.dependencies import StoreDep
from service.api.openapi import problems

router = APIRouter(tags=["health"])


class Alive(BaseModel):
    """The process answers."""

    status: Literal["alive"] = "alive"


class Ready(BaseModel):
    """It can do its work."""

    status: Literal["ready"] = "ready"
    store: Literal["writable"] = "writable"


@router.get("/healthz")
def healthz() -> Alive:
    """Say that the process is alive."""
    return Alive()


@router.get("/readyz", responses=problems())
def readyz(store: StoreDep) -> Ready:
    """Say that the store can be written; a problem otherwise."""
    store.check_writable()
    return Ready()
