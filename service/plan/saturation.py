"""What to do with a block that will saturate."""

from typing import Literal

from pydantic import Field

from service.plan.part import PlanPart


class SaturationLookAhead(PlanPart):
    """Predict each flat's brightest column from the blocks before it."""

    action: Literal["note", "skip", "stop"] = "note"
    """`note` takes it all the same, `skip` leaves it out, `stop` ends the run there."""
    limit_percent: float = Field(default=98.0, gt=0, le=100)
    """Of full scale: a column whose mean is beyond counts as saturated."""
