"""Outside of which conditions a run must not go on."""

from pydantic import Field, model_validator

from service.plan.part import PlanPart


class Interlocks(PlanPart):
    """Ranges, checked before and after each block; leaving one ends the run, lamps off.

    This is software: it protects a measurement, and is no safety interlock.
    """

    camera_temperature_c: tuple[float, float] | None = None
    """Lowest and highest temperature of the sensor."""
    monitor_a: tuple[float, float] | None = None
    """Lowest and highest current of the monitor while lamps burn and are settled."""
    max_lost_percent: float = Field(default=20.0, ge=0, le=100)
    """Lost frames of a block, of those tried; more than that is a broken link."""

    @model_validator(mode="after")
    def _ordered(self) -> "Interlocks":
        for name in ("camera_temperature_c", "monitor_a"):
            limits = getattr(self, name)
            if limits is not None and limits[0] > limits[1]:
                msg = f"{name} must be [lowest, highest]"
                raise ValueError(msg)
        return self
