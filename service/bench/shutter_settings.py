"""How a bench makes darks."""

from typing import Annotated, Literal

from pydantic import Field

from service.bench.part import BenchPart


class RelayShutterPart(BenchPart):
    """A shutter at a USB-RLY16 relay."""

    driver: Literal["rly16"] = "rly16"
    port: str | None = None
    """None: the simulation's."""
    relay: int = Field(default=1, ge=1, le=8)
    capped_when_on: bool = True
    travel_s: float = Field(default=0.3, ge=0)


class MockShutterPart(BenchPart):
    """Caps the simulation's camera, in this process."""

    driver: Literal["mock"] = "mock"


class LampsOffShutterPart(BenchPart):
    """A dark is a block with the lamps off, in a dark room; each one costs a lamp cycle."""

    driver: Literal["lamps_off"] = "lamps_off"
    afterglow_s: float = Field(default=5.0, ge=0)
    """How long to wait until the filaments are dark."""


class OperatorShutterPart(BenchPart):
    """A person puts the cap on and takes it off, when asked."""

    driver: Literal["none"] = "none"


ShutterPart = Annotated[
    RelayShutterPart | MockShutterPart | LampsOffShutterPart | OperatorShutterPart,
    Field(discriminator="driver"),
]
