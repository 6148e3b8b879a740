"""When the light counts as steady."""

from pydantic import Field, model_validator

from service.plan.part import PlanPart


class Settle(PlanPart):
    """After a change of level: wait until the monitor's readings stay within a tolerance.

    Stable means that over the last `stable_for_s` the readings' span (largest minus smallest)
    is at most `tolerance_percent` of their mean.
    """

    tolerance_percent: float = Field(default=0.2, gt=0)
    stable_for_s: float = Field(default=5.0, ge=0)
    timeout_s: float = Field(default=900.0, gt=0)
    interval_s: float = Field(default=0.5, gt=0)
    """Between two readings."""
    without_monitor_s: float = Field(default=30.0, ge=0)
    """How long to wait on a bench that has no monitor."""

    @model_validator(mode="after")
    def _can_end(self) -> "Settle":
        if self.timeout_s <= self.stable_for_s:
            msg = "timeout_s must be longer than stable_for_s, or it can never be stable in time"
            raise ValueError(msg)
        return self
