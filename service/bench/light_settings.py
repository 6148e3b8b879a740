"""Which light a bench has."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from service.bench.part import BenchPart


class GenLightPart(BenchPart):
    """Lamps, one current-regulated GEN supply for each; level n burns the first n."""

    driver: Literal["gen"] = "gen"
    port: str | None = None
    """None: the simulation's."""
    addresses: tuple[Annotated[int, Field(ge=0, le=30)], ...] = ()
    """Of the supplies, lamp 1 first; empty: the simulation's."""
    nominal_current_a: float = Field(default=4.0, gt=0)
    voltage_limit_v: float = Field(default=40.0, gt=0)
    ramp_step_a: float = Field(default=0.5, gt=0)
    ramp_step_s: float = Field(default=0.1, ge=0)
    tolerance_a: float = Field(default=0.02, gt=0)
    hours_path: Path | None = None
    """The file in which lamp hours are counted, relative to the bench file."""
    baudrate: int = Field(default=9600, gt=0)
    timeout_s: float = Field(default=1.0, gt=0)
    """How long a reply may take."""


class MightexLightPart(BenchPart):
    """An LED in continuous current; level 1 is its nominal current."""

    driver: Literal["mightex"] = "mightex"
    port: str | None = None
    """None: the simulation's."""
    channel: int = Field(default=1, ge=1)
    nominal_current_ma: float = Field(default=500.0, gt=0)
    max_current_ma: float = Field(default=1000.0, gt=0)
    baudrate: int = Field(default=9600, gt=0)


class MockLightPart(BenchPart):
    """The simulation's lamps without any line, in this process."""

    driver: Literal["mock"] = "mock"
    tau_s: float = Field(default=0.05, ge=0)
    """Time constant of their warming up."""
    ramp_s: float = Field(default=0.02, ge=0)


LightPart = Annotated[
    GenLightPart | MightexLightPart | MockLightPart, Field(discriminator="driver")
]
