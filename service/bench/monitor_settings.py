"""Which monitor a bench has."""

from typing import Annotated, Literal

from pydantic import Field

from service.bench.part import BenchPart


class KeithleyMonitorPart(BenchPart):
    """A photodiode at a Keithley 6485 picoammeter."""

    driver: Literal["keithley6485"] = "keithley6485"
    port: str | None = None
    """None: the simulation's."""
    range_a: float | None = Field(default=None, gt=0)
    """None: the meter chooses its range itself."""
    nplc: float = Field(default=1.0, gt=0)
    """Integration time in periods of the mains."""
    mains_hz: float = Field(default=50.0, gt=0)
    baudrate: int = Field(default=9600, gt=0)
    timeout_s: float = Field(default=1.0, gt=0)
    """How long a reply may take beyond the integration."""


class MockMonitorPart(BenchPart):
    """A photodiode that sees the simulation's lamps, in this process."""

    driver: Literal["mock"] = "mock"
    integration_s: float = Field(default=0.02, gt=0)
    range_a: float = Field(default=2e-5, gt=0)


class NoMonitorPart(BenchPart):
    """Nothing watches the source; settling is a wait."""

    driver: Literal["none"] = "none"


MonitorPart = Annotated[
    KeithleyMonitorPart | MockMonitorPart | NoMonitorPart, Field(discriminator="driver")
]
