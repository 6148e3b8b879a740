"""The light, as its certificate describes it."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from service.plan.by_level import levels_quoted
from service.plan.part import PlanPart

Share = Annotated[float, Field(ge=0, lt=1)]
"""A part of the radiance: 0.01 is 1 %."""


class PlanSource(PlanPart):
    """Goes into the recording's header; `radiance` gives each flat its nominal radiance.

    Each `_std` is a standard uncertainty (k = 1), relative; a certificate often prints twice that.
    What is not stated counts as 0 in the budget of a calibration, which then says so.
    """

    kind: Literal["sphere", "led", "lamp", "none"] = "sphere"
    lamps: int | None = Field(default=None, ge=0)
    """How many the source has; None: as many as the plan's highest level needs."""
    identity: str = ""
    """Free text: make and serial number."""
    radiance_unit: str = "W m-2 sr-1"
    radiance: Annotated[
        dict[float, Annotated[float, Field(ge=0)]], BeforeValidator(levels_quoted)
    ] = Field(default_factory=dict)
    """Nominal radiance by level; a level that is missing here is unknown, not 0."""
    wavelength_nm: float | None = Field(default=None, gt=0)
    photons_per_pixel_per_us: float | None = Field(default=None, gt=0)
    """At level 1."""
    certificate_relative_std: Share | None = None
    """Of all radiances together, as the certificate states it. None: not stated."""
    level_relative_std: Share | None = None
    """Of each level's radiance apart from that. None: seen from how the levels agree."""
    nonuniformity_relative: Share | None = None
    """Half-width ±h of what the radiance may differ by over the field that the camera sees."""
    monitor_relative_std: Share | None = None
    """Of carrying the certified radiance over to the day of the run by the monitor."""
    standard: str = ""
    """The radiance standard that the certificate traces to."""
    certificate: str = ""
    """The certificate's identifier."""
