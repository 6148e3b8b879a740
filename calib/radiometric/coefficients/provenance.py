"""Where a coefficient set comes from and where it holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field

Range = tuple[float, float]
"""Lowest and highest value, both included."""

Parameter = str | float | int | bool | None


@dataclass(frozen=True)
class Domain:
    """What the calibration has seen; outside it a result is extrapolated.

    Attributes:
        exposure_us: Exposure times.
        dn: Block means of single columns that entered the fit.
        radiance: Radiances, in the set's unit.
        temperature_c: Sensor temperatures; None where none was recorded.
    """

    exposure_us: Range
    dn: Range
    radiance: Range
    temperature_c: Range | None = None


@dataclass(frozen=True)
class Provenance:
    """What makes a set repeatable.

    Attributes:
        recording_digest: `Recording.digest()` of the recording.
        recording_name: Its file's name, for people.
        started_at: When the recording started, ISO 8601; "" where unknown.
        plan: The plan that was run, as text; "" where unknown.
        software_version: darkflat's version.
        method: Name of the method.
        parameters: The method's parameters.
        radiance_standard: The standard that the radiances trace to; "" where not stated.
        certificate: Its certificate's identifier; "" where not stated.
    """

    recording_digest: str
    recording_name: str = ""
    started_at: str = ""
    plan: str = ""
    software_version: str = ""
    method: str = "AgCam 2010, Eqs. 1-3"
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    radiance_standard: str = ""
    certificate: str = ""
