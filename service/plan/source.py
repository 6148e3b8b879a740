"""The light, as its certificate describes it."""

from typing import Annotated, Literal

from pydantic import Field

from service.plan.part import PlanPart


class PlanSource(PlanPart):
    """Goes into the recording's header; `radiance` gives each flat its nominal radiance."""

    kind: Literal["sphere", "led", "lamp", "none"] = "sphere"
    lamps: int | None = Field(default=None, ge=0)
    """How many the source has; None: as many as the plan's highest level needs."""
    identity: str = ""
    """Free text: make, serial number, certificate."""
    radiance_unit: str = "W m-2 sr-1"
    radiance: dict[float, Annotated[float, Field(ge=0)]] = Field(default_factory=dict)
    """Nominal radiance by level; a level that is missing here is unknown, not 0."""
    wavelength_nm: float | None = Field(default=None, gt=0)
    photons_per_pixel_per_us: float | None = Field(default=None, gt=0)
    """At level 1."""
