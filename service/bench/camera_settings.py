"""Which camera a bench has."""

from typing import Annotated, Literal

from pydantic import Field

from service.bench.part import BenchPart


class AravisCameraPart(BenchPart):
    """A GigE Vision or USB3 Vision camera."""

    driver: Literal["aravis"] = "aravis"
    address: str | None = None
    """An IP address, a host name or `Vendor-Serial`; None: the simulated camera's."""
    packet_size: int | None = Field(default=None, gt=0)
    """Bytes per GigE Vision packet; None: the driver chooses."""


class MockCameraPart(BenchPart):
    """The simulation's model without any transport, in this process."""

    driver: Literal["mock"] = "mock"
    paced: bool = True
    """False: frames come as fast as they are drawn."""


CameraPart = Annotated[AravisCameraPart | MockCameraPart, Field(discriminator="driver")]
