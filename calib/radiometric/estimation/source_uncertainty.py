"""What is known about the source apart from the recording: type B."""

import math
from dataclasses import dataclass, fields
from typing import Self

from calib.errors import InputError
from calib.recording.header import SourceHeader


@dataclass(frozen=True)
class SourceUncertainty:
    """Stated by the certificate and by who set the source up; None is not stated.

    Every field that a recording's header has can stand under its name in `[source]` of
    recording.toml. AgCam's source is Lambertian, and with it uniform, within 1 % (section 3):
    `nonuniformity_relative = 0.01`.

    Attributes:
        certificate_relative_std: Standard uncertainty (k = 1) of all radiances together.
        level_relative_std: Standard uncertainty of each level's radiance apart from that; None
            takes it from how well the levels agree with one another.
        nonuniformity_relative: Half-width ±h of a rectangular distribution.
        monitor_relative_std: Standard uncertainty of carrying the certified radiance over to the
            day of the recording by the monitor.
        standard: The radiance standard that the certificate traces to.
        certificate: The certificate's identifier.
        spectral_response_relative_std: What the uncertainty of the camera's spectral response
            brings into all radiances together, where they were computed from the lamps' spectra
            (`radiances_from_spectra`); None where they were not.
    """

    certificate_relative_std: float | None = None
    level_relative_std: float | None = None
    nonuniformity_relative: float | None = None
    monitor_relative_std: float | None = None
    standard: str = ""
    certificate: str = ""
    spectral_response_relative_std: float | None = None

    def __post_init__(self) -> None:
        for name in (
            "certificate_relative_std",
            "level_relative_std",
            "nonuniformity_relative",
            "monitor_relative_std",
            "spectral_response_relative_std",
        ):
            value = getattr(self, name)
            is_number = isinstance(value, int | float) and math.isfinite(value)
            if value is not None and not (is_number and 0 <= value < 1):
                message = f"The source's {name} is {value}: give a number from 0 to below 1."
                raise InputError(message, code="bad-source-uncertainty")

    @classmethod
    def of_header(cls, source: SourceHeader) -> Self:
        """Return what the recording's header states."""
        stated = {f.name for f in fields(cls)} & set(SourceHeader.model_fields)
        return cls(**{name: getattr(source, name) for name in stated})
