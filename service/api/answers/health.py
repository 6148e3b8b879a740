"""How the service is, as it tells it."""

from typing import Literal

from pydantic import BaseModel, Field


class Alive(BaseModel):
    """The process answers."""

    status: Literal["alive"] = "alive"


class Ready(BaseModel):
    """It can do its work."""

    status: Literal["ready"] = "ready"
    store: Literal["writable"] = "writable"
    bench: Literal["reachable", "none"] = Field(description="`none`: the service has no bench.")
