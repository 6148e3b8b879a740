"""How the lamps are held between blocks."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from service.plan.by_level import levels_quoted
from service.plan.part import PlanPart

LampMode = Literal["keep", "off_between_blocks"]


class LampUse(PlanPart):
    """Lamps age by hours and by cycles; which of the two to spare depends on the level."""

    mode: LampMode = "keep"
    """`keep`: they burn on, behind the cap of a dark too. `off_between_blocks`: off after each."""
    per_level: Annotated[dict[float, LampMode], BeforeValidator(levels_quoted)] = Field(
        default_factory=dict
    )
    """The mode of single levels, e.g. `{ 6 = "off_between_blocks" }`."""
    while_paused: Literal["off", "warm"] = "off"
    """What they do while a run is paused. `warm`: they burn on, and settle before it goes on."""
    ramp_s: float = Field(default=1.3, ge=0)
    """What lighting one lamp, or putting one out, takes; for the time estimate only."""
    read_back_s: float = Field(default=0.2, ge=0)
    """What reading one lamp's supply back takes on its line; for the time estimate only."""

    def mode_at(self, level: float) -> LampMode:
        """Return how lamps are held after a block at `level`."""
        return self.per_level.get(level, self.mode)
