"""Where the darks go."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from service.plan.part import PlanPart

DarkPlacement = Literal["interleaved", "before", "after", "none"]


class Darks(PlanPart):
    """Capped blocks, at each exposure of the sweep, in each repeat."""

    placement: DarkPlacement = "interleaved"
    """`interleaved` spreads them evenly through the flats, so that a drift of the offset shows."""
    per_exposure: int = Field(default=1, ge=1)
    """How many blocks at each exposure, per repeat."""


def placed(value: Any) -> Any:
    """Read `"before"` as `{placement = "before"}`."""
    return {"placement": value} if isinstance(value, str) else value


DarksField = Annotated[Darks, BeforeValidator(placed)]
